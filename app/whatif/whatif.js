const NAME = "what-if"
const made = (tag, more = {}, ...children) => {
  const one = Object.assign(document.createElement(tag), more)
  one.append(...children)
  return one
}
const saved = (blob, name) => {
  const href = URL.createObjectURL(blob)
  made("a", {href, download: name}).click()
  setTimeout(() => URL.revokeObjectURL(href), 1e4)
}
const filled = (select, options, value) => {
  const all = options.some(([one]) => one === value) ? options : [...options, [value, value]]
  const text = JSON.stringify(all)
  if (select.text !== text) {
    select.text = text
    select.replaceChildren(...all.map(([name, title]) => new Option(title, name)))
  }
  select.value = value
}
// What somebody is typing stays as it is until it is told.
const put = (input, value) => {
  if (input.getRootNode().activeElement !== input || !input.typed) { input.value = value }
}
const typed = (className, ariaLabel, tell) => {
  const input = made("input", {className, ariaLabel})
  input.oninput = () => { input.typed = true }
  input.onchange = () => { input.typed = false; tell() }
  return input
}
// The fields of one setting and its values.
const spanned = (place, heading, tell) => {
  const shown = {}
  const send = (more = {}) => tell("span", {place, span: {name: select.value, low: low.value,
    high: high.value, count: count.value, spacing: spacing.value, listed: listed.value, ...more}})
  const label = (words) => `${heading}: ${words}`
  const select = made("select", {ariaLabel: label("setting"), onchange: () => send()})
  const low = typed("low", label("from"), send), high = typed("high", label("to"), send)
  const count = typed("count", label("how many values"), send)
  const listed = typed("listed", label("values, commas between them"), send)
  const spacing = made("select", {ariaLabel: label("spacing"), onchange: () => send()})
  filled(spacing, [["even", "even steps"], ["log", "even ratios"], ["list", "a list"]], "even")
  const names = made("span"), refused = made("span", {className: "refused", role: "alert"})
  const parts = [low, "to", high, "in", count, "values,"].map((one) =>
    typeof one === "string" ? made("span", {}, one) : one)
  const row = made("div", {className: "row"}, made("b", {}, heading), select, ...parts, listed,
    spacing, names, refused)
  shown.row = row
  shown.show = (form) => {
    const span = form.spans[place] ?? {name: "", spacing: "even"}
    const own = form.settings.find(({name}) => name === span.name)
    const options = form.settings.map((one) =>
      [one.name, one.unit ? `${one.title} (${one.unit})` : one.title])
    filled(select, place ? [["", "nothing else"], ...options] : options, span.name)
    const isNamed = Boolean(own?.of.length), isListed = span.spacing === "list"
    for (const one of parts) { one.hidden = !span.name || isListed }
    listed.hidden = !span.name || !isListed || isNamed
    spacing.hidden = !span.name || isNamed
    names.hidden = !isNamed
    spacing.value = span.spacing
    const values = [[low, span.low], [high, span.high], [count, span.count], [listed, span.listed]]
    for (const [input, value] of values) { put(input, value ?? "") }
    refused.textContent = form.refusals[place] ?? ""
    const chosen = (span.listed ?? "").split(",")
    names.replaceChildren(...(own?.of ?? []).map((name) => {
      const box = made("input", {type: "checkbox", checked: chosen.includes(name), name})
      box.onchange = () => send({listed: [...names.querySelectorAll("input:checked")]
        .map((one) => one.name).join()})
      return made("label", {}, box, ` ${name} `)
    }))
  }
  return shown
}
export function render({model}) {
  const tell = (kind, value = null) => model.send_msg({kind, value})
  const spans = [spanned(0, "Over", tell), spanned(1, "and over", tell)]
  const ready = made("div", {className: "row"})
  const ask = () => tell("quantity", {name: quantity.value, at: at.value})
  const quantity = made("select", {ariaLabel: "Quantity", onchange: () => { at.value = ""; ask() }})
  const at = typed("at", "Its parameter", ask)
  const words = made("span"), refused = made("span", {className: "refused", role: "alert"})
  const button = (text, title, onclick) => made("button", {title, onclick}, text)
  const start = button("Start", "Run all of it.", () => tell("start"))
  start.className = "start"
  const cancel = button("Cancel", "End it; what has come stays.", () => tell("cancel"))
  const rest = made("span")
  const asked = made("div", {className: "row"}, made("b", {}, "Show"), quantity, words, at, start,
    cancel, rest, refused)
  const bar = made("progress", {ariaLabel: "Share of the runs"}), far = made("span")
  const exports = made("span", {className: "end"})
  exports.append(
    button("Table (CSV)", "Save the table of all runs.", () => tell("table")), " ",
    button("Chart (SVG)", "Save the chart.", () => saved(picture(), `${NAME}.svg`)), " ",
    button("Chart (PNG)", "Save the chart, painted.", () => painted()))
  const progress = made("div", {className: "row"}, bar, far, exports)
  const legend = made("div", {className: "legend"}), tip = made("output")
  const ended = made("span", {role: "status"})
  Object.assign(ended.style, {position: "absolute", clip: "rect(0 0 0 0)", overflow: "hidden"})
  const place = made("div", {className: "place", tabIndex: 0}, tip, ended)
  place.setAttribute("role", "application")
  tip.setAttribute("aria-live", "polite")
  const root = made("div", {className: "all"}, ready, ...spans.map(({row}) => row), asked, progress,
    legend, place)
  let paint = null, at_point = null, wasBusy = false
  let seen = {}, ghost = {}
  const read = () => {
    const before = seen.chart?.key, found = JSON.parse(model.ghost)
    seen = JSON.parse(model.picture)
    ghost = found.of && found.of === seen.chart?.key ? found : {}
    if (seen.chart?.key !== before) { say(null) }
    label()
    later()
  }
  const pictured_at = (width, height) =>
    pictured(seen.chart, seen.points, ghost, seen.here, width, height)
  const draw = () => {
    due = 0
    const {clientWidth, clientHeight} = place
    place.querySelector("svg")?.remove()
    paint = null
    progress.hidden = legend.hidden = !seen.chart
    if (!seen.chart || clientWidth < 80) { return }
    paint = pictured_at(clientWidth, clientHeight)
    paint.root.setAttribute("aria-hidden", "true")
    place.append(paint.root)
    if (at_point) { say(paint.places.find(({n}) => n === at_point.n) ?? null) }
  }
  let due = 0
  const later = () => { due ||= requestAnimationFrame(draw) }
  const label = () => {
    if (!seen.chart) { return }
    const {axes, quantity} = seen.chart, title = labelled(quantity)
    const keys = keyed(seen.chart, Boolean(ghost.chart)).map(([color, words, isDashed]) => {
      const mark = made("i", {className: isDashed ? "dashed" : ""})
      mark.style.setProperty("--mark", color)
      return made("span", {}, mark, words)
    })
    const hint = made("span", {}, "A click opens the run.")
    legend.replaceChildren(made("span", {}, made("b", {}, title)), ...keys, hint)
    place.ariaLabel = `${title} over ${axes.map(({title}) => title).join(" and ")}. ` +
      "Arrow keys go from run to run, Enter opens one."
  }
  const told = ({n}) => {
    const {axes, quantity} = seen.chart, {values, states, words} = seen.points
    const where = axes.map(({title, unit, values, step}) =>
      `${title} ${written(values[Math.floor(n / step) % values.length])}${unit && ` ${unit}`}`)
    const value = values[n] === null ? "" : `${written(values[n])} ${quantity.unit}`.trim()
    return [`${where.join(", ")}: ${[value, words[states[n]]].filter(Boolean).join("; ")}`]
  }
  const say = (point) => {
    at_point = point
    tip.textContent = point ? told(point)[0] : ""
    if (!point) { return }
    const {clientWidth, clientHeight} = place
    tip.style.left = `${Math.min(point.x + 12, clientWidth - tip.offsetWidth - 4)}px`
    const below = point.y + 14 + tip.offsetHeight < clientHeight
    tip.style.top = `${below ? point.y + 14 : point.y - 14 - tip.offsetHeight}px`
  }
  const nearest = (x, y) => {
    let best = null, least = seen.chart?.map ? Infinity : 40 ** 2
    for (const one of paint?.places ?? []) {
      const far = (one.x - x) ** 2 + (one.y - y) ** 2
      if (far < least) { [best, least] = [one, far] }
    }
    return best
  }
  const under = ({clientX, clientY}) => {
    const {left, top} = place.getBoundingClientRect(), {frame} = paint ?? {}
    const [x, y] = [clientX - left, clientY - top]
    const out = !frame || x < frame.left - 8 || x > frame.left + frame.w + 8 || y < frame.top - 8 ||
      y > frame.top + frame.h + 8
    return out ? null : nearest(x, y)
  }
  const open = (point) => { if (point) { tell("run", point.n) } }
  place.onpointermove = (event) => say(under(event))
  place.onpointerleave = () => say(null)
  place.onclick = (event) => open(under(event))
  place.onkeydown = (event) => {
    const way = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key]
    if (event.key === "Enter") { open(at_point) }
    if (event.key === "Escape") { say(null) }
    if (!way || !paint?.places.length) { return }
    event.preventDefault()
    const from = at_point ?? nearest(paint.frame.left, paint.frame.top + paint.frame.h) ??
      paint.places[0]
    // The nearest one that lies that way rather than any other.
    let best = null, least = Infinity
    for (const one of at_point ? paint.places : []) {
      const dx = one.x - from.x, dy = one.y - from.y, on = dx * way[0] + dy * way[1]
      const off = Math.abs(dx * way[1]) + Math.abs(dy * way[0])
      const far = on + 3 * off
      if (on > 0.5 && far < least) { [best, least] = [one, far] }
    }
    say(best ?? from)
  }
  const picture = () => {
    const style = getComputedStyle(place), {clientWidth, clientHeight} = place
    const {root} = pictured_at(clientWidth, clientHeight)
    const paper = style.getPropertyValue("--paper").trim() || "#fff"
    const [head, more] = headed(seen.chart, Boolean(ghost.chart), clientWidth)
    const height = clientHeight + more
    root.setAttribute("y", more)
    const all = drawn("svg", {xmlns: SVG, width: clientWidth, height, color: style.color,
      viewBox: `0 0 ${clientWidth} ${height}`, fill: "currentColor", "font-size": 13,
      "font-family": "sans-serif"},
      drawn("rect", {width: clientWidth, height, fill: paper}), head, root)
    const text = new XMLSerializer().serializeToString(all)
    return new Blob([text.replaceAll("var(--paper, #fff)", paper)], {type: "image/svg+xml"})
  }
  const painted = async () => {
    const image = new Image(), url = URL.createObjectURL(picture())
    image.src = url
    await image.decode()
    const canvas = made("canvas", {width: 2 * image.width, height: 2 * image.height})
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height)
    URL.revokeObjectURL(url)
    canvas.toBlob((blob) => saved(blob, `${NAME}.png`))
  }
  const show = () => {
    const {form} = model
    ready.hidden = !form.ready.length
    const names = JSON.stringify(form.ready)
    if (ready.names !== names) {
      ready.names = names
      ready.replaceChildren(made("b", {}, "Ready"),
        ...form.ready.map(([title, help]) => button(title, help, () => tell("ready", title))))
    }
    for (const one of spans) { one.show(form) }
    filled(quantity, form.quantities.map(({name, title}) => [name, title]), form.quantity)
    const own = form.quantities.find(({name}) => name === form.quantity)
    const [before, after] = (own?.at ?? "").split("{:g}")
    at.hidden = !own?.at
    words.textContent = [before, after].filter((one) => one?.trim()).join(" … ").trim()
    put(at, form.at)
    refused.textContent = form.refusals.of ?? form.refusals.all ?? ""
    start.disabled = Object.keys(form.refusals).length > 0
    rest.textContent = `All else is as in the controls: ${form.rest}.`
  }
  const follow = () => {
    const {busy, share, words, moved} = model.progress
    cancel.hidden = bar.hidden = !busy
    bar.value = share ?? 0
    const note = moved ? " The controls have changed since; Start asks again." : ""
    far.textContent = `${words ?? ""}${note}`
    if (wasBusy && !busy) { ended.textContent = words }
    wasBusy = busy
  }
  model.on("form", show)
  model.on("progress", follow)
  for (const name of ["picture", "ghost"]) { model.on(name, read) }
  model.on("file", () => saved(new Blob([model.file[0]], {type: "text/csv"}), model.file[1]))
  const watcher = new ResizeObserver(later)
  watcher.observe(place)
  model.on("remove", () => watcher.disconnect())
  show()
  follow()
  read()
  return root
}
