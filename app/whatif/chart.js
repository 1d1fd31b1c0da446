// A chart of runs: curves over one setting, or a map with contours over two.
const SVG = "http://www.w3.org/2000/svg"
const drawn = (tag, more = {}, ...children) => {
  const made = document.createElementNS(SVG, tag)
  for (const [name, value] of Object.entries(more)) { made.setAttribute(name, value) }
  made.append(...children)
  return made
}
const written = (value) => {
  if (typeof value !== "number") { return String(value) }
  const size = Math.abs(value), rounded = Number(value.toPrecision(4))
  const plain = size === 0 || (size >= 1e-3 && size < 1e5)
  return (plain ? String(rounded) : rounded.toExponential().replace("+", "")).replaceAll("-", "−")
}
const labelled = ({title, unit}) => unit ? `${title} (${unit})` : title
// Numbers that are easily read, at most so many of them.
const rounds = (low, high, most) => {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough))
  const step = power * [1, 2, 5, 10].find((one) => one * power >= rough)
  const count = Math.floor(high / step + 1e-9) - Math.ceil(low / step - 1e-9) + 1
  return Array.from({length: Math.max(count, 0)},
    (_, i) => Number(((Math.ceil(low / step - 1e-9) + i) * step).toPrecision(12)))
}
const powers = (low, high, most) => {
  const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high))
  if (high / low < 10) { return rounds(low, high, most) }
  const parts = (last - first) * 3 <= 1.2 * most ? [1, 2, 5] : [1]
  const every = Math.ceil((last - first) / most)
  return Array.from({length: last - first + 1}, (_, i) => first + i)
    .filter((power) => (power - first) % every === 0)
    .flatMap((power) => parts.map((part) => Number((part * 10 ** power).toPrecision(1))))
    .filter((value) => value >= low * 0.999 && value <= high * 1.001)
}
// Where values stand between 0 and 1, and which of them are written.
const scaled = (low, high, log, most) => {
  const to = log ? Math.log : (value) => value
  const [from, till] = [to(low), to(high)], width = till - from || 1
  const written = (many) => (log ? powers : rounds)(low, high, many)
  return {log, place: (value) => (to(value) - from) / width, ticks: written(most),
    levels: written(log ? 14 : 8)}
}
const along = (axis, most, margin) => {
  const {values, log, numeric} = axis
  if (!numeric) {
    const place = (value) => (values.indexOf(value) + 0.5) / values.length
    return {place, ticks: values, middle: true}
  }
  const low = Math.min(...values), high = Math.max(...values)
  const by = log ? (high / low) ** margin : (high - low) * margin || 1
  return log ? scaled(low / by, high * by, true, most) : scaled(low - by, high + by, false, most)
}
// The scale of what is asked; of decades, where it goes over several.
const upward = (values, decades, most, margin) => {
  const known = values.filter((value) => value !== null)
  if (!known.length) { return scaled(0, 1, false, most) }
  const low = Math.min(...known), high = Math.max(...known)
  if (low > 0 && high > decades * low) {
    const by = (high / low) ** margin
    return scaled(low / by, high * by, true, most)
  }
  const by = (high - low) * margin || Math.abs(high) / 2 || 1
  return scaled(low >= 0 && low < by ? 0 : low - by, high + by, false, most)
}
const mixed = (colors, share) => {
  const at = Math.min(Math.max(share, 0), 1) * (colors.length - 1), i = Math.min(Math.floor(at),
    colors.length - 2)
  const part = (color, k) => parseInt(color.slice(1 + 2 * k, 3 + 2 * k), 16)
  const mix = [0, 1, 2].map((k) =>
    Math.round(part(colors[i], k) * (1 - at + i) + part(colors[i + 1], k) * (at - i)))
  return `rgb(${mix.join()})`
}
// Lines on which values between four points each come to a level.
const contour = (grid, level, x, y) => {
  const pieces = []
  for (let i = 0; i + 1 < grid.length; i++) {
    for (let j = 0; j + 1 < grid[i].length; j++) {
      const ring = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]
      const found = ring.map(([a, b]) => grid[a][b])
      if (found.some((value) => value === null)) { continue }
      const cuts = []
      for (let k = 0; k < 4; k++) {
        const [v, w] = [found[k], found[(k + 1) % 4]]
        if ((v < level) === (w < level)) { continue }
        const t = (level - v) / (w - v), [[a, b], [c, d]] = [ring[k], ring[(k + 1) % 4]]
        cuts.push([x[a] + t * (x[c] - x[a]), y[b] + t * (y[d] - y[b])])
      }
      for (let k = 0; k + 1 < cuts.length; k += 2) { pieces.push([cuts[k], cuts[k + 1]]) }
    }
  }
  return pieces
}
const edges = (places) => places.map((_, i) => {
  const at = (k) => places[Math.min(Math.max(k, 0), places.length - 1)]
  const half = (k) => places.length < 2 ? 0.5 : k < 0 ? at(0) - (at(1) - at(0)) / 2
    : k >= places.length - 1 ? at(k) + (at(k) - at(k - 1)) / 2 : (at(k) + at(k + 1)) / 2
  return [half(i - 1), half(i)]
})
const ordered = (axis) => axis.values.map((_, i) => i)
  .sort((i, j) => axis.numeric ? axis.values[i] - axis.values[j] : i - j)
const HATCH = "hatched"
// The parts of a picture of a given size: its points with their numbers, and what is drawn.
function pictured(chart, points, ghost, here, width, height) {
  const [across, up] = chart.axes, isMap = chart.map
  const left = 66, right = isMap ? 84 : 16, top = 10, bottom = 46
  const w = Math.max(width - left - right, 40), h = Math.max(height - top - bottom, 40)
  const many = Math.max(Math.floor(w / 70), 2), high = Math.max(Math.floor(h / 42), 2)
  const x = along(across, many, isMap ? 0.5 / Math.max(across.values.length - 1, 1) : 0.02)
  const good = points.values.map((value, i) => points.states[i] === 1 ? value : null)
  const shadow = ghost.points ? ghost.points.values.map((v, i) => ghost.points.states[i] === 1 ? v : null)
    : []
  const asked = isMap ? good : [...points.values, ...shadow]
  const z = upward(asked, chart.decades, high, isMap ? 0 : 0.06)
  const y = isMap ? along(up, high, 0.5 / Math.max(up.values.length - 1, 1)) : z
  const px = (value) => left + w * x.place(value), py = (value) => top + h * (1 - y.place(value))
  const frame = {left, top, w, h}, places = []
  const root = drawn("svg", {width, height, viewBox: `0 0 ${width} ${height}`, xmlns: SVG,
    "font-family": "sans-serif", "font-size": 13, fill: "currentColor"})
  const text = (words, at) => drawn("text", at, words)
  for (const value of x.ticks) {
    const at = px(value)
    root.append(
      drawn("path", {d: `M${at} ${top}V${top + h}`, stroke: "currentColor", opacity: 0.12}),
      text(written(value), {x: at, y: top + h + 17, "text-anchor": "middle"}))
  }
  for (const value of y.ticks) {
    const at = py(value)
    root.append(
      drawn("path", {d: `M${left} ${at}H${left + w}`, stroke: "currentColor", opacity: 0.12}),
      text(written(value), {x: left - 6, y: at + 4, "text-anchor": "end"}))
  }
  const words = labelled(isMap ? up : chart.quantity), fits = 7 * words.length < height
  const title = fits ? words : chart.quantity.unit
  root.append(
    drawn("rect", {x: left, y: top, width: w, height: h, fill: "none", stroke: "currentColor",
      opacity: 0.5}),
    text(labelled(across), {x: left + w / 2, y: height - 8, "text-anchor": "middle"}),
    text(title, {transform: `translate(15 ${top + h / 2}) rotate(-90)`, "text-anchor": "middle"}))
  const paint = {root, chart, points, good, frame, x, y, z, px, py, places, here, ghost, shadow}
  ;(isMap ? mapped : curved)(paint)
  return paint
}
// A picture that is taken away has its words in it.
function headed(chart, hasGhost, width) {
  const group = drawn("g"), keys = keyed(chart, hasGhost)
  group.append(drawn("text", {x: 8, y: 16, "font-weight": 600}, labelled(chart.quantity)))
  let x = 8, y = keys.length ? 36 : 16
  for (const [color, words, isDashed] of keys) {
    const wide = 30 + 7.5 * words.length
    if (x > 8 && x + wide > width) { [x, y] = [8, y + 18] }
    group.append(drawn("path", {d: `M${x} ${y - 4}h18`, stroke: color, "stroke-width": 3,
      "stroke-dasharray": isDashed ? "5 4" : "none"}), drawn("text", {x: x + 23, y}, words))
    x += wide
  }
  return [group, y + 8]
}
// Colour and words of every curve, and whether it is dashed.
const keyed = ({axes: [, up], map, hues}, hasGhost) => [
  ...(map || !up ? [] : up.values).map((value, k) =>
    [hues[k % hues.length], `${up.title} ${written(value)}${up.unit && ` ${up.unit}`}`, false]),
  ...(hasGhost ? [["currentColor", "the chart before", true]] : []),
]
// A ring where the present settings stand.
const marked = ({root}, cx, cy) => root.append(
  drawn("circle", {cx, cy, r: 8, fill: "none", stroke: "#fff", "stroke-width": 4}),
  drawn("circle", {cx, cy, r: 8, fill: "none", stroke: "#D55E00", "stroke-width": 2.5}))
// Lines through what there is; nothing lies between names.
const broken = (line, px, py) => {
  if (line.some(([value]) => typeof value !== "number")) { return "" }
  let d = "", isDown = false
  for (const [value, result] of line) {
    if (result === null) { isDown = false; continue }
    d += `${isDown ? "L" : "M"}${px(value)} ${py(result)}`
    isDown = true
  }
  return d
}
function curved(paint) {
  const {root, chart, points, good, frame, px, py, places, here, ghost, shadow} = paint
  const [across, up] = chart.axes, order = ordered(across)
  const lines = (axes, each) => (axes[1]?.values ?? [null]).forEach((name, k) => each(name,
    (i) => i * axes[0].step + k * (axes[1]?.step ?? 0), chart.hues[k % chart.hues.length]))
  if (ghost.chart) {
    const old = ghost.chart.axes
    lines(old, (name, number, color) => root.append(drawn("path", {fill: "none", stroke: color,
      opacity: 0.4, "stroke-width": 2, "stroke-dasharray": "5 4", "data-part": "ghost",
      d: broken(ordered(old[0]).map((i) => [old[0].values[i], shadow[number(i)]]), px, py)})))
  }
  const [now, same] = here
  const isHere = across.numeric ? now >= Math.min(...across.values) && now <= Math.max(...across.values)
    : across.values.includes(now)
  if (isHere) {
    root.append(drawn("path", {d: `M${px(now)} ${frame.top}v${frame.h}`, stroke: "#D55E00",
      "stroke-width": 1.5, "stroke-dasharray": "2 3", "data-part": "here"}))
  }
  lines(chart.axes, (name, number, color) => {
    // What runs had come to that have not converged stands apart, but shows the way.
    root.append(drawn("path", {fill: "none", stroke: color, opacity: 0.35,
      d: broken(order.map((i) => [across.values[i], points.values[number(i)]]), px, py)}))
    root.append(drawn("path", {fill: "none", stroke: color, "stroke-width": 2,
      d: broken(order.map((i) => [across.values[i], good[number(i)]]), px, py)}))
    across.values.forEach((value, i) => {
      const n = number(i), result = points.values[n], state = points.states[n]
      if (!state) { return }
      const cx = px(value), cy = result === null ? frame.top + 8 : py(result)
      places.push({n, x: cx, y: cy})
      if (result === null) {
        root.append(drawn("path", {d: `M${cx - 4} ${cy - 4}l8 8m0 -8l-8 8`, stroke: color,
          "stroke-width": 2, "data-part": "nothing"}))
        return
      }
      root.append(drawn("circle", {cx, cy, r: 3.6, stroke: color, "stroke-width": 1.6,
        fill: state === 1 ? color : "var(--paper, #fff)",
        "data-part": state === 1 ? "answer" : "hollow"}))
      if (value === now && (!up || name === same)) { marked(paint, cx, cy) }
    })
  })
}
function mapped(paint) {
  const {root, chart, points, good, frame, x, y, z, px, py, places, here, ghost, shadow} = paint
  const [across, up] = chart.axes, {left, top, w, h} = frame
  const [xs, ys] = [across, up].map(ordered)
  const wide = edges(xs.map((i) => x.place(across.values[i])))
  const tall = edges(ys.map((j) => y.place(up.values[j])))
  const number = (i, j) => xs[i] * across.step + ys[j] * up.step
  root.append(drawn("defs", {}, drawn("pattern", {id: HATCH, width: 6, height: 6,
    patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)"},
    drawn("path", {d: "M0 0v6", stroke: "currentColor", "stroke-width": 2, opacity: 0.55}))))
  xs.forEach((_, i) => ys.forEach((_, j) => {
    const n = number(i, j), value = points.values[n], state = points.states[n]
    if (!state) { return }
    const box = {x: left + w * wide[i][0], y: top + h * (1 - tall[j][1]),
      width: w * (wide[i][1] - wide[i][0]) + 0.4, height: h * (tall[j][1] - tall[j][0]) + 0.4}
    places.push({n, x: box.x + box.width / 2, y: box.y + box.height / 2})
    if (state === 1) {
      root.append(drawn("rect", {...box, fill: mixed(chart.scale, z.place(value)),
        "shape-rendering": "crispEdges", "data-part": "answer"}))
    } else { root.append(drawn("rect", {...box, fill: `url(#${HATCH})`, "data-part": "hollow"})) }
  }))
  const screen = (axes, orders) => [
    orders[0].map((i) => px(axes[0].values[i])), orders[1].map((j) => py(axes[1].values[j]))]
  const grid = (values, axes, orders) => orders[0].map((i) => orders[1].map((j) =>
    values[i * axes[0].step + j * axes[1].step]))
  const levels = z.levels.filter((level) => z.place(level) > 0.001 && z.place(level) < 0.999)
  const lines = (values, axes, orders, look) => levels.map((level) => {
    const pieces = contour(grid(values, axes, orders), level, ...screen(axes, orders))
    root.append(drawn("path", {fill: "none", ...look,
      d: pieces.map(([[a, b], [c, d]]) => `M${a} ${b}L${c} ${d}`).join("")}))
    return pieces
  })
  if (ghost.chart) {
    const old = ghost.chart.axes
    lines(shadow, old, old.map(ordered), {stroke: "#fff", opacity: 0.75, "stroke-width": 1.2,
      "stroke-dasharray": "4 4", "data-part": "ghost"})
  }
  const found = lines(good, chart.axes, [xs, ys], {stroke: "#000", opacity: 0.75,
    "stroke-width": 1.1, "data-part": "contour"})
  found.forEach((pieces, k) => {
    if (pieces.length < 4) { return }
    const [[a, b]] = pieces[Math.floor(pieces.length / 2)]
    root.append(drawn("text", {x: a, y: b + 4, "text-anchor": "middle", fill: "#000",
      stroke: "#fff", "stroke-width": 3, "paint-order": "stroke", "font-size": 12},
      written(levels[k])))
  })
  const [nowX, nowY] = here
  const inside = (place) => place >= 0 && place <= 1
  if (here.length && inside(x.place(nowX)) && inside(y.place(nowY))) {
    marked(paint, px(nowX), py(nowY))
  }
  const bar = left + w + 14, steps = 40
  for (let k = 0; k < steps; k++) {
    root.append(drawn("rect", {x: bar, y: top + h * (1 - (k + 1) / steps), width: 12,
      height: h / steps + 0.5, fill: mixed(chart.scale, (k + 0.5) / steps)}))
  }
  for (const value of good.some((one) => one !== null) ? z.ticks : []) {
    root.append(drawn("text", {x: bar + 17, y: top + h * (1 - z.place(value)) + 4}, written(value)))
  }
}
