// Goes through the runs of a chart: a tap opens the nearest; arrow keys go from one to the next.
const NEAR = 40
const runs = ({model, frame}) => model.renderers.flatMap(({data_source: {data}}) =>
  Array.from(data.number ?? [], (number, i) => ({number, said: data.said[i],
    x: frame.x_scale.compute(data.x[i]), y: frame.y_scale.compute(data.y[i])})))
const least = (all, measure, most = Infinity) => {
  let best = null
  for (const one of all) {
    const far = measure(one)
    if (far < most) { [best, most] = [one, far] }
  }
  return best
}
// A cell of a map may be larger than what is near a point.
const nearest = (view, sx, sy) => {
  const isMap = view.model.renderers.some(({data_source: {data}}) => data.left)
  if (isMap && !view.frame.bbox.contains(sx, sy)) { return null }
  return least(runs(view), ({x, y}) => Math.hypot(x - sx, y - sy), isMap ? Infinity : NEAR)
}
const WAYS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}
const next = (view, from, [across, up]) => least(runs(view), ({x, y}) => {
  const on = (x - from.x) * across + (y - from.y) * up
  const off = Math.abs((x - from.x) * up) + Math.abs((y - from.y) * across)
  return on > 0.5 ? on + 3 * off : Infinity
})
// A figure is in the page some time after it is named.
function walk(seen, label, there, open) {
  const view = seen()
  if (!view?.el?.isConnected) {
    requestAnimationFrame(() => walk(seen, label, there, open))
    return
  }
  if (view.walked) { return }
  view.walked = true
  there()
  const {el} = view, tip = document.createElement("output")
  let at = null
  Object.assign(el, {tabIndex: 0, role: "application",
    ariaLabel: `${label} Arrow keys go from run to run, Enter opens one.`})
  tip.setAttribute("aria-live", "polite")
  Object.assign(tip.style, {position: "absolute", zIndex: 1, padding: "4px 8px", display: "none",
    background: "Canvas", color: "CanvasText", border: "1px solid", maxWidth: "300px"})
  el.shadowRoot.append(tip)
  const say = (run) => {
    at = run
    tip.textContent = run?.said ?? ""
    tip.style.display = run ? "block" : "none"
    if (run) {
      tip.style.left = `${Math.min(run.x + 12, el.clientWidth - tip.offsetWidth)}px`
      tip.style.top = `${Math.min(run.y + 12, el.clientHeight - tip.offsetHeight)}px`
    }
  }
  view.model.on_event("tap", ({sx, sy}) => {
    const run = nearest(view, sx, sy)
    if (run) { open(run.number) }
  })
  el.onblur = () => say(null)
  el.onkeydown = (event) => {
    const way = WAYS[event.key]
    if (event.key === "Enter" && at) { open(at.number) }
    if (event.key === "Escape") { say(null) }
    if (!way) { return }
    event.preventDefault()
    const {left, bottom} = view.frame.bbox
    const first = () => least(runs(view), ({x, y}) => Math.hypot(x - left, y - bottom))
    say(at ? next(view, at, way) ?? at : first())
  }
}
