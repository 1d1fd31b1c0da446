// As a picture may be that which stands there already, it is not waited for without end.
const LOOKS = 30
export function render({model}) {
  const seen = (slug) => plot_of(slug, model.caption)
  const plots = make("select", {ariaLabel: say("Plot")}), tables = make("select", {ariaLabel: say("Table")})
  const button = (name, title, onclick) =>
    make("button", {className: "wide", title: say(title), onclick}, say(name))
  const tell = (kind, value = "") => model.send_msg({kind, value})
  const saved = (how) => () => how(`slipfront-${plots.value}`, seen(plots.value))
  let frames = [], filmed = "", seen_last = ""
  const animate = (over) => () => {
    frames = []
    filmed = plots.value
    seen_last = model.caption
    tell("animate", over)
  }
  const paint = () => new Promise((done) =>
    requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))))
  // What is said of a picture comes with it; a shot may be asked for before it is there.
  const painted_anew = async () => {
    for (let looks = 0; looks < LOOKS && model.caption === seen_last; looks++) { await paint() }
    seen_last = model.caption
    await paint()
  }
  model.on("shot", async () => {
    const {shot} = model
    if (shot) {
      await painted_anew()
      // All of one size, though a legend may take another line.
      const canvas = await painted(seen(filmed), 1, frames[0])
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
    // What is no text comes in base 64.
    const isText = !name.endsWith(".hdf5")
    const content = isText ? text : Uint8Array.from(atob(text), (one) => one.charCodeAt(0))
    save(name, new Blob([content], {type: isText ? "text/plain" : "application/x-hdf5"}))
  })
  const show = () => {
    const {value} = plots
    plots.replaceChildren(...model.views.map(([name, slug]) => new Option(say(name), slug)))
    if (model.views.some(([, slug]) => slug === value)) { plots.value = value }
  }
  tables.append(...model.tables.map((name) => new Option(say(name), name)))
  model.on("views", show)
  show()
  return menu("Take away", "Pictures, animations, tables, and the program of this run.",
    make("label", {}, say("Plot"), plots),
    button("PNG", "Save the picture, with its name, legend and units.",
      saved(save_png)),
    button("SVG", "The same, as lines and words that can be edited.",
      saved(save_svg)),
    button("GIF over time", "Save its pictures at all instants as an animation.",
      animate("instants")),
    button("GIF over iterations", "Save its pictures from the first iteration to the last.",
      animate("iterations")),
    make("label", {}, say("Table"), tables),
    button("CSV", "Save the numbers that are drawn: along the interface at the chosen instant, " +
      "of the loaded end over time, or of all iterations.", () => tell("table", tables.value)),
    button("HTML", "Save this run as one file for a browser, which needs no network: the plots that " +
      "are seen, at all instants, and the numbers.", () => tell("table", "page")),
    button("Python", "Save a program that gives the numbers of this run again.",
      () => tell("program")),
    ...(model.fclib ? [button("FCLIB", "Save the contact problem of the chosen instant as a local " +
      "problem in FCLIB's format (HDF5), for other solvers such as Siconos.",
      () => tell("table", "fclib"))] : []))
}
