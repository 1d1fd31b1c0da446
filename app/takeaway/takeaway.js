const SVG = "http://www.w3.org/2000/svg", FONT = "system-ui, sans-serif", LINE = 20, FINE = 2
const DASHES = {dashed: "6 4", dotted: "2 3"}, WIDTHS = {band: 7, thin: 1.5}, EDGE = "#8a8a8a"
export function render({model}) {
  const make = (tag, more = {}, ...children) => {
    const made = Object.assign(document.createElement(tag), more)
    made.append(...children)
    return made
  }
  const drawn = (tag, attributes, text = "") => {
    const made = document.createElementNS(SVG, tag)
    for (const [name, value] of Object.entries(attributes)) { made.setAttribute(name, value) }
    made.textContent = text
    return made
  }
  const save = (name, blob) => {
    const href = URL.createObjectURL(blob)
    make("a", {href, download: name}).click()
    setTimeout(() => URL.revokeObjectURL(href), 1e4)
  }
  const named = (name) =>
    Bokeh.documents.map((one) => one.get_model_by_name(name)).find((one) => one)
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
      const group = drawn("g", {})
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
  // Name and legend stand on the card, beside the plot.
  const head = (slug, width, color) => {
    const {text} = named(`${slug}.title`)
    const {body} = new DOMParser().parseFromString(text, "text/html")
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
    put(model.caption, null, 400)
    return [group, y + LINE / 2]
  }
  const pictured = (slug) => {
    const range = named(`${slug}.x`), [plot] = range.document.roots()
    const seen = Bokeh.index.find_one(plot), {width} = seen.bbox
    const inner = seen.export("svg", false).ctx.get_svg()
    const {backgroundColor: paper, color} = getComputedStyle(document.body)
    const [words, top] = head(slug, width, color)
    const size = {width, height: seen.bbox.height + top}
    const whole = drawn("svg", {xmlns: SVG, ...size})
    inner.setAttribute("y", top)
    whole.append(drawn("rect", {...size, fill: paper}), words, inner)
    return {...size, paper, text: new XMLSerializer().serializeToString(whole)}
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
  const plots = make("select", {ariaLabel: "Plot"}), tables = make("select", {ariaLabel: "Table"})
  const button = (name, title, onclick) =>
    make("button", {className: "wide", title, onclick}, name)
  const tell = (kind, value = "") => model.send_msg({kind, value})
  const png = async () => {
    const canvas = await painted(pictured(plots.value), FINE)
    canvas.toBlob((blob) => save(`slipfront-${plots.value}.png`, blob))
  }
  const svg = () => {
    const blob = new Blob([pictured(plots.value).text], {type: "image/svg+xml"})
    save(`slipfront-${plots.value}.svg`, blob)
  }
  let frames = [], filmed = ""
  const animate = (over) => () => {
    frames = []
    filmed = plots.value
    tell("animate", over)
  }
  const paint = () => new Promise((done) =>
    requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))))
  model.on("shot", async () => {
    const {shot} = model
    if (shot) {
      await paint()
      // All of one size, though a legend may take another line.
      const canvas = await painted(pictured(filmed), 1, frames[0])
      frames.push(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height))
      tell("taken")
    } else if (frames.length) {
      const [{width, height}] = frames
      save(`slipfront-${filmed}.gif`, gif(frames, width, height, 10))
      frames = []
    }
  })
  model.on("file", () => {
    const [name, text] = model.file
    save(name, new Blob([text], {type: "text/plain"}))
  })
  const show = () => {
    const {value} = plots
    plots.replaceChildren(...model.views.map(([name, slug]) => new Option(name, slug)))
    if (model.views.some(([, slug]) => slug === value)) { plots.value = value }
  }
  tables.append(...model.tables.map((name) => new Option(name, name)))
  model.on("views", show)
  show()
  return make("div", {}, make("h4", {}, "Take away"),
    make("label", {}, "Plot", plots),
    button("PNG", "Save the picture, with its name, legend and units.", png),
    button("SVG", "The same, as lines and words that can be edited.", svg),
    button("GIF over time", "Save its pictures at all instants as an animation.",
      animate("instants")),
    button("GIF over iterations", "Save its pictures from the first iteration to the last.",
      animate("iterations")),
    make("label", {}, "Table", tables),
    button("CSV", "Save the numbers that are drawn: along the interface at the chosen instant, " +
      "of the loaded end over time, or of all iterations.", () => tell("table", tables.value)),
    button("Python", "Save a program that gives the numbers of this run again.",
      () => tell("program")))
}
