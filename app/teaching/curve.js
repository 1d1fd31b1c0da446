// Axes on which a curve is drawn by hand, and beside it, in the end, what was measured.
const PAD = {width: 360, height: 200, left: 48, below: 36, above: 8, columns: 72}
const sketchpad = ({across, up, places, top, values}, sketch, keep) => {
  const {width, height, left, below, above, columns} = PAD
  const right = width - 12, bottom = height - below, ends = [places[0], places.at(-1)].map(Math.log)
  const share = (x) => (Math.log(x) - ends[0]) / (ends[1] - ends[0])
  const along = (x) => left + 10 + (right - left - 20) * share(x)
  const high = (y) => bottom - (bottom - above) * Math.log(y) / Math.log(top)
  const pad = drawn("svg", {viewBox: `0 0 ${width} ${height}`, class: "pad", role: "img",
    "aria-label": say(values.length ? "{} over {}: drawn by hand, and measured"
      : "{} over {}: drawn by hand", say(up), say(across))})
  const put = (tag, attributes, text) => pad.append(drawn(tag, attributes, text))
  const word = (x, y, text, anchor = "middle") =>
    put("text", {x, y, "text-anchor": anchor, "font-size": 12, fill: "currentColor"}, text)
  put("rect", {x: left, y: above, width: right - left, height: bottom - above, fill: "none",
    stroke: "currentColor", "stroke-opacity": 0.5})
  for (const place of places) { word(along(place), bottom + 15, String(place)) }
  for (let y = 1; y <= top; y *= 10) {
    put("line", {x1: left, x2: right, y1: high(y), y2: high(y), stroke: "currentColor",
      "stroke-opacity": 0.15})
    word(left - 5, high(y) + 4, String(y), "end")
  }
  word((left + right) / 2, height - 4, say(across))
  put("text", {transform: `translate(12 ${(above + bottom) / 2}) rotate(-90)`, "font-size": 12,
    "text-anchor": "middle", fill: "currentColor"}, say(up.split(" to ")[0]))
  const line = drawn("path", {fill: "none", stroke: "#D55E00", "stroke-width": 3})
  const show = () => {
    const points = sketch.map((y, column) => [left + (column + 0.5) * (right - left) / columns, y])
      .filter(([, y]) => y !== null)
    const parts = points.map(([x, y], number) => `${number ? "L" : "M"}${x} ${y}`)
    line.setAttribute("d", parts.join(""))
  }
  pad.append(line)
  values.forEach((value, number) => {
    const x = along(places[number]), y = value === null ? above + 9 : high(value)
    put("circle", {cx: x, cy: y, r: 5, fill: "#0072B2"})
    if (value === null) { word(x, above + 28, say("never")) }
  })
  let last = null
  const draw = (event) => {
    const box = pad.getBoundingClientRect(), size = width / box.width
    const x = (event.clientX - box.left) * size, y = (event.clientY - box.top) * size
    const column = Math.floor((x - left) / (right - left) * columns)
    if (column < 0 || column >= columns) { return }
    const level = Math.min(Math.max(y, above), bottom), [from, before] = last ?? [column, level]
    // A quick hand skips columns.
    for (let at = Math.min(from, column); at <= Math.max(from, column); at++) {
      const done = column === from ? 1 : (at - from) / (column - from)
      sketch[at] = before + done * (level - before)
    }
    last = [column, level]
    show()
  }
  if (!values.length) {
    pad.style.touchAction = "none"
    pad.onpointerdown = (event) => {
      pad.setPointerCapture(event.pointerId)
      last = null
      draw(event)
    }
    pad.onpointermove = (event) => { if (event.buttons) { draw(event) } }
    pad.onpointerup = keep
  }
  show()
  return pad
}
const blank = () => Array(PAD.columns).fill(null)
