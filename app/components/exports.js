// Plots as files: drawn once more as SVG with what stands above them, and painted of that.
const FONT = "system-ui, sans-serif", LINE = 20, FINE = 2
const DASHES = {dashed: "6 4", dotted: "2 3"}, WIDTHS = {band: 7, thin: 1.5}, EDGE = "#8a8a8a"
const ruler = make("canvas").getContext("2d")
const wide = (text, weight) => {
  ruler.font = `${weight} 14px ${FONT}`
  return ruler.measureText(text).width
}
const mark = ({className, style}, x, y) => {
  const color = style.getPropertyValue("--mark"), middle = {cx: x + 8, cy: y}
  if (className === "square") {
    return drawn("rect", {x: x + 2, y: y - 6, width: 12, height: 12, fill: color,
      stroke: EDGE})
  }
  if (className === "front") {
    const edge = {x: x + 1, y: y - 6, width: 14, height: 12, fill: "#d9d9d9", stroke: EDGE}
    const group = drawn("g")
    group.append(drawn("rect", edge), drawn("rect", {...edge, y: y - 1, height: 2, fill: color,
      stroke: "none"}))
    return group
  }
  if (className === "dot") { return drawn("circle", {...middle, r: 4, fill: color}) }
  if (className === "ring") {
    return drawn("circle", {...middle, r: 4, fill: "none", stroke: color, "stroke-width": 2})
  }
  if (className === "cross") {
    return drawn("text", {x: x + 4, y: y + 5, fill: color, "font-weight": 700}, "×")
  }
  return drawn("line", {x1: x, x2: x + 16, y1: y, y2: y, stroke: color,
    "stroke-width": WIDTHS[className] ?? 3, "stroke-dasharray": DASHES[className] ?? "none"})
}
// Name and legend stand beside the plot, as HTML.
const head = (html, caption, width, color) => {
  const {body} = new DOMParser().parseFromString(html, "text/html")
  const group = drawn("g", {"font-family": FONT, "font-size": 14, fill: color})
  let x = 12, y = LINE
  const put = (text, shape, weight) => {
    const gap = shape && shape.className !== "bare" ? 20 : 0
    if (x > 12 && x + gap + wide(text, weight) > width) { [x, y] = [12, y + LINE] }
    if (gap) { group.append(mark(shape, x, y - 5)) }
    group.append(drawn("text", {x: x + gap, y, "font-weight": weight}, text))
    x += gap + wide(text, weight) + 12
  }
  put(body.querySelector("b").textContent, null, 700)
  for (const one of body.querySelectorAll(".key")) {
    put(one.textContent, one.querySelector("i"), 400)
  }
  put(caption, null, 400)
  return [group, y + LINE / 2]
}
const pictured = (seen, html, caption) => {
  const {width} = seen.bbox
  const inner = seen.export("svg", false).ctx.get_svg()
  const {backgroundColor: paper, color} = getComputedStyle(document.body)
  const [words, top] = head(html, caption, width, color)
  const size = {width, height: seen.bbox.height + top}
  const whole = drawn("svg", {xmlns: SVG, ...size})
  inner.setAttribute("y", top)
  whole.append(drawn("rect", {...size, fill: paper}), words, inner)
  return {...size, paper, text: new XMLSerializer().serializeToString(whole)}
}
const named = (name) =>
  Bokeh.documents.map((one) => one.get_model_by_name(name)).find((one) => one)
const is_drawn = (slug) => named(`${slug}.x`) !== undefined
const plot_of = (slug, caption) => {
  const [plot] = named(`${slug}.x`).document.roots()
  return pictured(Bokeh.index.find_one(plot), named(`${slug}.title`).text, caption)
}
const painted = async ({width, height, paper, text}, scale, size = {width, height}) => {
  const image = new Image(), type = "image/svg+xml"
  image.src = URL.createObjectURL(new Blob([text], {type}))
  await image.decode()
  const canvas = make("canvas", {width: scale * size.width, height: scale * size.height})
  const pen = canvas.getContext("2d")
  pen.fillStyle = paper
  pen.fillRect(0, 0, canvas.width, canvas.height)
  pen.drawImage(image, 0, 0, scale * width, scale * height)
  URL.revokeObjectURL(image.src)
  return canvas
}
const save_svg = (name, {text}) => save(`${name}.svg`, new Blob([text], {type: "image/svg+xml"}))
const save_png = async (name, picture) => {
  const canvas = await painted(picture, FINE)
  canvas.toBlob((blob) => save(`${name}.png`, blob))
}
