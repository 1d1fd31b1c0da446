// What stands for a setting in a picture is taken hold of, and dragged along itself; a tap on it is
// one on what lies behind it.
function handles(place, plot, source, model, tap) {
  const NEAR = 12, grip = document.createElement("div"), said = document.createElement("output")
  grip.className = "grip"
  said.className = "gripped"
  grip.hidden = said.hidden = true
  place.append(grip, said)
  let held = null, due = false
  const tell = (value) => model.send_msg({
    kind: "drag", value: {name: held.setting, value, hand: true, count: performance.now()},
  })
  // Where ends are on the screen: the first, the direction, the length, pixels a metre.
  const placed = ([[x, across], [y, up]]) => {
    const view = Bokeh.index.find_one_by_id(plot.id), {x_scale, y_scale} = view.frame
    const {left, top} = view.canvas_view.el.getBoundingClientRect()
    const from = [left + x_scale.compute(x), top + y_scale.compute(y)]
    const along = [left + x_scale.compute(across) - from[0], top + y_scale.compute(up) - from[1]]
    const length = Math.hypot(...along)
    const unit = along.map((one) => one / length)
    return {from, unit, length, metre: length / Math.hypot(across - x, up - y)}
  }
  const way = ({clientX, clientY}, [x, y], unit) =>
    (clientX - x) * unit[0] + (clientY - y) * unit[1]
  // Of all handles that the page has a slider for, the one at a pointer.
  const near = (event) => {
    const {xs, ys, setting, value, rate, is_metric} = source.data
    let best = null, least = NEAR
    setting.forEach((name, i) => {
      if (!(name in model.sliders)) { return }
      const own = [xs[i], ys[i]], {from, unit, length, metre} = placed(own)
      const on = Math.min(Math.max(way(event, from, unit), 0), length)
      const far = Math.hypot(
        event.clientX - from[0] - on * unit[0], event.clientY - from[1] - on * unit[1])
      if (far < least) {
        least = far
        const per = is_metric[i] ? rate[i] / metre : rate[i]
        best = {setting: name, value: value[i], per, ends: own}
      }
    })
    return best
  }
  const label = ({clientX, clientY}, {setting, value}) => {
    const {left, top, width} = place.getBoundingClientRect(), item = model.sliders[setting]
    const [unit, factor] = step_of(value || item.end, item.steps)
    const told = written(scaled(value, factor), item)
    said.textContent = `${say(item.label)}: ${told} ${unit}`.trim()
    said.style.top = `${Math.max(clientY - top - 40, 2)}px`
    const room = width - said.offsetWidth - 4
    said.style.left = `${Math.max(Math.min(clientX - left + 10, room), 2)}px`
  }
  const show = (event, found, longer = 0) => {
    grip.hidden = said.hidden = !found
    if (!found) { return }
    const {left, top} = place.getBoundingClientRect(), {from, unit, length} = placed(found.ends)
    Object.assign(grip.style, {
      left: `${from[0] - left - NEAR}px`, top: `${from[1] - top - NEAR}px`,
      width: `${Math.max(length + longer, 0) + 2 * NEAR}px`, height: `${2 * NEAR}px`,
      transformOrigin: `${NEAR}px 50%`,
      transform: `rotate(${Math.atan2(unit[1], unit[0])}rad)`,
    })
    label(event, found)
  }
  const move = (event) => {
    const item = model.sliders[held.setting]
    if (!item) { return release(event) }
    const {unit} = placed(held.ends), longer = way(event, held.at, unit)
    const start = item.log ? Math.log10(held.value) : held.value
    const value = settled(item, start + held.per * longer)
    const [low, high] = [Math.min(item.start, held.value), Math.max(item.end, held.value)]
    const wanted = Math.min(Math.max(value, low), high)
    show(event, {...held, value: wanted}, longer)
    if (wanted === held.told) { return }
    Object.assign(held, {told: wanted, has_moved: true})
    tell(wanted)
  }
  const release = ({type, clientX, clientY}) => {
    if (!held) { return }
    if (held.has_moved) { tell(null) }
    else if (type === "pointerup") {
      const {frame: {x_scale, y_scale}, canvas_view: {el}} = Bokeh.index.find_one_by_id(plot.id)
      const {left, top} = el.getBoundingClientRect()
      tap({x: x_scale.invert(clientX - left), y: y_scale.invert(clientY - top)})
    }
    held = null
    grip.classList.remove("held")
    show(null, null)
  }
  place.addEventListener("pointerdown", (event) => {
    const found = event.button === 0 && near(event)
    if (!found) { return }
    event.stopPropagation()
    event.preventDefault()
    show(event, found)
    held = {...found, told: found.value, at: [event.clientX, event.clientY]}
    grip.classList.add("held")
    grip.setPointerCapture(event.pointerId)
  }, {capture: true})
  // A finger would move the page.
  place.addEventListener("touchstart", (event) => { if (held) { event.preventDefault() } },
    {capture: true, passive: false})
  place.addEventListener("pointermove", (event) => {
    if (due && !held) { return }
    if (held) {
      event.stopPropagation()
      return move(event)
    }
    due = true
    requestAnimationFrame(() => {
      due = false
      if (!held) { show(event, near(event)) }
    })
  }, {capture: true})
  for (const end of ["pointerup", "pointercancel"]) { place.addEventListener(end, release) }
  place.addEventListener("pointerleave", () => { if (!held) { show(null, null) } })
}
