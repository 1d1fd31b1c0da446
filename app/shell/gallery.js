// The number of the quadrilateral at a point, or -1.
const pick = ({xs, ys}, x, y) => {
  const holds = (across, up) => {
    let inside = false
    for (let i = 0, j = across.length - 1; i < across.length; j = i++) {
      const between = up[i] > y !== up[j] > y
      if (between && x < across[i] + (y - up[i]) / (up[j] - up[i]) * (across[j] - across[i])) {
        inside = !inside
      }
    }
    return inside
  }
  return xs.findIndex((across, i) => holds(across, ys[i]))
}
// What is coloured by something else is no substructure.
const substructure = (data, x, y) => {
  const value = data.value[pick(data, x, y)]
  return Number.isInteger(value) ? value + 1 : undefined
}
// How far a point is from lines, of which the nearest has a name.
const nearest = ({xs, ys, name}, x, y) => {
  let best, least = Infinity
  xs.forEach((across, number) => {
    for (let i = 0; i + 1 < across.length; i++) {
      const [left, low] = [across[i], ys[number][i]]
      const [wide, tall] = [across[i + 1] - left, ys[number][i + 1] - low]
      const share = ((x - left) * wide + (y - low) * tall) / (wide * wide + tall * tall)
      const on = Math.min(Math.max(share, 0), 1)
      const far = Math.hypot(x - left - on * wide, y - low - on * tall)
      if (far < least) { [best, least] = [name[number], far] }
    }
  })
  return [best, least]
}
export function render({model}) {
  const figures = JSON.parse(model.figures), root = document.createElement("div")
  root.className = "grid"
  // The document hears nothing of a focus that moves within the page's own tree.
  root.addEventListener("focusin", ({target}) =>
    target.dispatchEvent(new CustomEvent("plot-focus", {bubbles: true, composed: true})))
  const cards = new Map(), {index, embed} = Bokeh, {Document} = Bokeh.require("document")
  // A drag tells where it is now, not everywhere it has been.
  let told = null
  const listen = (plot, kind, bodies) => {
    const at = ({x, y}) => kind === "wire" ? Math.round(y) - 1
      : bodies ? substructure(bodies.data, x, y) : kind === "time" ? x : y
    const choose = (event) => {
      const value = at(event)
      if (value === undefined) { return }
      if (!told) { requestAnimationFrame(() => { model.send_msg(told); told = null }) }
      told = {kind, value}
    }
    for (const event of ["tap", "pan"]) { plot.on_event(event, choose) }
    return choose
  }
  // A tap chooses the interface beside it, and marks its place on a body.
  const NEAR = 4
  const touch = (plot, bodies, along, contacts) => ({x, y}) => {
    const {x_scale} = Bokeh.index.find_one_by_id(plot.id).frame
    const [name, far] = nearest(contacts.data, x, y), at = pick(bodies.data, x, y)
    if (far * (x_scale.compute(1) - x_scale.compute(0)) < NEAR) {
      model.send_msg({kind: "interface", value: name})
    }
    const on = along.data.x[at]
    if (on !== undefined) { model.send_msg({kind: "place", value: on}) }
  }
  // What a screen reader says of a plot beside its name: what is drawn, and of which moment.
  const describe = (element, slug) => {
    const said = model.said.find(([of]) => of === slug)?.[1] ?? ""
    element.ariaDescription = `${said} ${model.caption}`.trim()
  }
  const make = (slug) => {
    const {json, name, chooses} = figures[slug]
    const box = (className) => {
      const made = document.createElement("div")
      made.className = className
      return made
    }
    const element = box("card"), title = box("title"), place = box("plot")
    const [before, seen, after, legend] = ["span", "b", "span", "span"].map((tag) =>
      document.createElement(tag))
    title.append(before, seen, after, legend)
    Object.assign(element, {role: "figure", ariaLabel: say(name), tabIndex: 0})
    element.append(title, place)
    const made = Document.from_json(json), [plot] = made.roots()
    const words = made.get_model_by_name(`${slug}.title`)
    const write = () => {
      const {content} = Object.assign(document.createElement("template"), {innerHTML: words.text})
      const own = content.querySelector("b")
      if (own.innerHTML !== seen.innerHTML) { seen.innerHTML = own.innerHTML }
      own.remove()
      legend.replaceChildren(content)
    }
    // Views that may stand in its place are called where they stand in their order.
    let offered = []
    const tabs = (names) => {
      if (String(names) === String(offered)) { return }
      offered = names
      const found = names.map((other) => {
        const tab = Object.assign(document.createElement("button"), {textContent: say(other)})
        tab.onclick = () => {
          turned = other
          model.send_msg({kind: "tab", value: [name, other]})
        }
        return tab
      })
      const at = names.indexOf(name)
      before.replaceChildren(...found.slice(0, Math.max(at, 0)))
      after.replaceChildren(...found.slice(at + 1))
    }
    words.properties.text.change.connect(write)
    write()
    describe(element, slug)
    const [bodies, held, along, contacts] = ["bodies", "handles.drawn", "along", "contacts"].map(
      (one) => made.get_model_by_name(`${slug}.${one}`))
    const choose = chooses ? listen(plot, chooses, bodies) : null
    const chosen = contacts ? touch(plot, bodies, along, contacts) : null
    if (chosen) { plot.on_event("tap", chosen) }
    if (held) {
      handles(place, plot, held, model, (event) => [choose, chosen].forEach((one) => one(event)))
    }
    if (slug === "convergence") {
      const {button, show} = bathtub(plot, () => model.send_msg({kind: "bathtub", value: ""}))
      place.append(button)
      model.on("bathtub", () => show(model.bathtub))
      show(model.bathtub)
    }
    // Pictures find its models from now on; they are drawn one after the other.
    cards.set(slug, {element, name, place, made, plot, tabs, drawn: false})
  }
  // The title of an axis for which there is no room has a second line: its unit, or its last word.
  const pen = document.createElement("canvas").getContext("2d")
  const wrap = (plot) => {
    const {axis_views = [], canvas_view} = index.find_one_by_id(plot.id) ?? {}
    for (const {model: axis, visuals} of axis_views.filter((one) => plot.left.includes(one.model))) {
      const line = axis.axis_label.replace("\n", " ")
      pen.font = visuals.axis_label_text.font_value()
      const fits = pen.measureText(line).width <= plot.inner_height + plot.min_border_top
      const title = fits ? line : line.replace(/ (\([^()]*\)|\S+)$/, "\n$1")
      if (title === axis.axis_label) { continue }
      axis.setv({axis_label: title}, {sync: false})
      // Bokeh clears all but half a pixel, where the longer title has left a trace.
      canvas_view.primary.ctx.clearRect(0, 0, canvas_view.bbox.width, 1)
    }
  }
  const keep_wrapped = (plot) => {
    const again = () => requestAnimationFrame(() => wrap(plot))
    plot.properties.inner_height.change.connect(again)
    for (const axis of plot.left) { axis.properties.axis_label.change.connect(again) }
    again()
  }
  const frame = () => new Promise((done) => requestAnimationFrame(done))
  // Empty axes would be laid out and painted for nothing.
  let pictured
  const picture = new Promise((done) => { pictured = done })
  if (model.caption) { pictured() }
  let drawing = picture
  const draw = async (slug) => {
    const one = cards.get(slug)
    if (one.drawn || !one.element.isConnected) { return }
    one.drawn = true
    dress(one)
    await embed.add_document_standalone(one.made, one.place)
    keep_wrapped(one.plot)
    await frame()
  }
  // Who has turned to another view has the focus there.
  let turned = ""
  const show = () => {
    const [template, row, isLong] = model.grid
    root.classList.toggle("long", isLong)
    root.style.setProperty("--template", template)
    root.style.setProperty("--row", row)
    const wanted = model.shown.map(([slug, area, names]) => {
      if (!cards.has(slug)) { make(slug) }
      const one = cards.get(slug)
      one.element.style.setProperty("--area", area)
      one.tabs(names)
      return one
    })
    if (wanted.length !== root.children.length ||
        wanted.some(({element}, i) => element !== root.children[i])) {
      root.replaceChildren(...wanted.map(({element}) => element))
    }
    wanted.find(({name}) => name === turned)?.element.querySelector(".title button")?.focus()
    turned = ""
    for (const [slug] of model.shown) { drawing = drawing.then(() => draw(slug)) }
  }
  // Colours and type of axes are in the style sheet, which Bokeh reads only when it paints.
  // They do not reach glyphs and the scale of colours.
  const dress = (card) => {
    const size = `${Math.round(13 * model.magnified)}px`, {color} = getComputedStyle(root)
    const paper = getComputedStyle(root).getPropertyValue("--mui-palette-background-paper").trim()
    const worn = `${size} ${color}`, {plot} = card
    if (card.worn === worn) { return }
    card.worn = worn
    for (const {glyph} of plot.renderers.filter(({glyph}) => glyph.type === "Text")) {
      glyph.setv({text_font_size: {value: size}, text_color: {value: color},
        background_fill_color: {value: paper}})
    }
    for (const one of plot.right) {
      one.setv({title_text_color: color, title_text_font_size: size,
        major_label_text_color: color, major_label_text_font_size: size})
    }
    index.find_one_by_id(plot.id)?.invalidate_layout()
  }
  // Which plots were chosen last for every scene stays in the browser, which may refuse to keep it.
  const KEPT = "slipfront-plots"
  const kept = () => {
    try { return Object.entries(JSON.parse(localStorage.getItem(KEPT)) ?? {}) } catch { return [] }
  }
  const recalled = kept()
  if (recalled.length) { model.recalls = Object.fromEntries(recalled) }
  model.on("keeps", () => {
    const all = Object.fromEntries([...kept(), model.keeps])
    try { localStorage.setItem(KEPT, JSON.stringify(all)) } catch {}
  })
  const tell_all = () => cards.forEach(({element}, slug) => describe(element, slug))
  const restyle = () => requestAnimationFrame(() => cards.forEach(dress))
  const watcher = new MutationObserver(restyle)
  watcher.observe(document.documentElement, {attributes: true, attributeFilter: ["data-theme", "data-built"]})
  model.on(["shown", "grid"], show)
  model.on("magnified", restyle)
  model.on("caption", () => {
    pictured()
    tell_all()
  })
  model.on("said", tell_all)
  model.on("remove", () => {
    watcher.disconnect()
    for (const {made} of cards.values()) { made.clear() }
  })
  show()
  return root
}
