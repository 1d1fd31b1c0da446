export function render({model}) {
  const root = document.createElement("div"), said = document.createElement("output")
  const button = document.createElement("button")
  root.append(said, button)
  root.hidden = true
  let found = new Map(), card = null, figure = null, pointer = null, alone = null
  const figures = () =>
    Bokeh.documents.flatMap((one) => one.roots()).filter((one) => one.type === "Plot")
  const look = () => {
    found = new Map(figures().map((one) => [Bokeh.index.find_one_by_id(one.id), one])
      .filter(([seen]) => seen).map(([seen]) => [seen.el, seen]))
  }
  // The element of a card and the view of its figure, of all that an event passes through.
  const met = (path) => {
    const on = path.find((one) => one.classList?.contains("card"))
    const plot = on?.querySelector(".bk-Plot")
    if (plot && !found.has(plot)) { look() }
    return [on ?? null, found.get(plot) ?? null]
  }
  const put = () => {
    root.hidden = !card?.checkVisibility()
    if (root.hidden) { return }
    const {right, top} = card.getBoundingClientRect()
    root.style.right = `${document.documentElement.clientWidth - right + 5}px`
    root.style.top = `${top + 4}px`
    button.textContent = card === alone ? "✕" : "⤢"
    button.title = button.ariaLabel = say(card === alone ? "All plots (Escape)" : "Whole page (f)")
  }
  const place = () => {
    if (!figure || !pointer) { return null }
    const {left, top} = figure.canvas_view.el.getBoundingClientRect(), {bbox} = figure.frame
    const [x, y] = [pointer.clientX - left, pointer.clientY - top]
    if (!bbox.contains(x, y)) { return null }
    return [figure.frame.x_scale.invert(x), figure.frame.y_scale.invert(y)]
  }
  const written = (value, axis) => {
    const unit = /\(([^()]*)\)$/.exec(axis.axis_label ?? "")?.[1] ?? ""
    return `${powers(Number(value.toPrecision(3)))} ${unit}`.trim()
  }
  const read = () => {
    const at = place(), [across] = figure?.model.below ?? [], [up] = figure?.model.left ?? []
    said.textContent = at && across ? `${written(at[0], across)}, ${written(at[1], up)}` : ""
  }
  // Another tab takes the card away without a move of the pointer.
  const sizes = new ResizeObserver(put)
  const see = (path) => {
    [card, figure] = met(path)
    sizes.disconnect()
    if (card) { sizes.observe(card) }
    put()
    read()
  }
  let due = 0
  const see_soon = (pathed) => {
    if (due) { return }
    due = requestAnimationFrame(() => {
      due = 0
      const path = pathed()
      if (!path.includes(root)) { see(path) }
    })
  }
  const follow = (event) => {
    pointer = event
    const path = event.composedPath()
    heed(path)
    see_soon(() => path)
  }
  // What lies under a pointer that rests changes as the page moves, and as plots are made and laid
  // out; nothing else tells of that.
  const roots = new WeakSet()
  const heed = (path) => {
    for (const one of path.filter((one) => one instanceof ShadowRoot && !roots.has(one))) {
      roots.add(one)
      one.addEventListener("scroll", moved, {capture: true, passive: true})
    }
  }
  const under = () => around(beneath(pointer.clientX, pointer.clientY))
  const moved = () => { if (pointer) { see_soon(under) } }
  const focus = (event) => {
    const path = event.composedPath()
    if (path.includes(root)) { return }
    // What was to be looked at under the pointer in the next frame is no longer asked for.
    cancelAnimationFrame(due)
    due = 0
    pointer = null
    see(path)
  }
  // While one has zoomed in, what pictures want of an axis is kept for afterwards (`pulse.js`).
  const release = (one) => {
    if (!one?.held) { return }
    const held = one.held
    delete one.held
    one.setv(held, {sync: false})
  }
  const ticker = (axis) => axis?.ticker.type === "FixedTicker" ? axis.ticker : null
  const all = (plot = figure) => {
    if (!plot) { return }
    const {x_range, y_range, below, left} = plot.model
    for (const one of [x_range, y_range, ticker(below[0]), ticker(left[0])]) { release(one) }
  }
  const ticks = (one, {start, end}) => {
    if (!one) { return }
    one.held ??= {ticks: one.ticks}
    const first = Math.floor(Math.log10(start)), steps = end / start < 1e3 ? [1, 2, 5] : [1]
    const powers = Array.from({length: Math.ceil(Math.log10(end)) - first}, (_, i) => first + i)
    one.setv({ticks: powers.flatMap((p) => steps.map((s) => s * 10 ** p))}, {sync: false})
  }
  const zoomed = (range, scale, at, by) => {
    const [to, from] = scale.type === "LogScale" ? [Math.log, Math.exp] : [(v) => v, (v) => v]
    const held = range.held ??= {start: range.start, end: range.end}
    const middle = to(at ?? from((to(range.start) + to(range.end)) / 2))
    const moved = (value) => from(middle + (to(value) - middle) * by)
    const values = {start: moved(range.start), end: moved(range.end)}
    range.setv(values, {sync: false})
    return to(values.end) - to(values.start) < to(held.end) - to(held.start)
  }
  const zoom = (by) => {
    if (!figure) { return }
    const {x_range, y_range, x_scale, y_scale, below, left} = figure.model
    const [x, y] = place() ?? []
    const isIn = zoomed(x_range, x_scale, x, by) && zoomed(y_range, y_scale, y, by)
    if (!isIn) { return all() }
    ticks(ticker(below[0]), x_range)
    ticks(ticker(left[0]), y_range)
  }
  const wheel = (event) => {
    const [on] = met(event.composedPath())
    if (!on || !event.ctrlKey && on !== alone) { return }
    event.preventDefault()
    pointer = event
    zoom(event.deltaY > 0 ? 1.25 : 0.8)
    read()
  }
  const enlarge = (one) => {
    alone?.classList.remove("alone")
    all()
    alone = one
    one?.classList.add("alone")
    requestAnimationFrame(put)
  }
  const leave = (event) => {
    if (event.key === "Escape" && alone) { enlarge(null) }
  }
  const keys = {
    "f": () => enlarge(alone?.isConnected ? null : card), "0": () => all(),
    "+": () => zoom(0.8), "-": () => zoom(1.25),
  }
  const press = (event) => keys[event.detail]?.()
  const back = (event) => { if (met(event.composedPath())[0]) { all() } }
  button.onclick = () => keys.f()
  // Bokeh lays a plot out too large that shrinks, as words above it grow, while it is painted.
  const timer = setInterval(() => {
    moved()
    for (const one of figures()) {
      const seen = Bokeh.index.find_one_by_id(one.id), laid = seen?.layout?.bbox
      if (laid && laid.height !== seen.bbox.height) { seen.invalidate_layout() }
    }
  }, 500)
  const listeners = {pointermove: follow, focusin: focus, "plot-focus": focus, dblclick: back,
    keydown: leave, "plot-key": press}
  for (const [name, does] of Object.entries(listeners)) { document.addEventListener(name, does) }
  document.addEventListener("wheel", wheel, {passive: false})
  model.on("remove", () => {
    clearInterval(timer)
    sizes.disconnect()
    document.removeEventListener("wheel", wheel)
    for (const [name, does] of Object.entries(listeners)) {
      document.removeEventListener(name, does)
    }
  })
  return root
}
