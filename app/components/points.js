// A path through points that are dragged, added by a double click and taken away by another.
function drawn_points(send) {
  const WIDE = 280, TALL = 110, ROOM = 10
  const picture = drawn("svg", {viewBox: `0 0 ${WIDE} ${TALL}`, class: "path"})
  const help = say("Drag a point; double click adds one, or takes it away.")
  picture.append(drawn("title", {}, help))
  let points = [], limits = [0, 1, 0, 1], held = null, moved = false, fixed = false
  let told = String
  const across = (x) => ROOM + (WIDE - 2 * ROOM) * (x - limits[0]) / (limits[1] - limits[0])
  const up = (y) => TALL - ROOM - (TALL - 2 * ROOM) * (y - limits[2]) / (limits[3] - limits[2])
  const place = (event) => {
    const box = picture.getBoundingClientRect()
    const x = (event.clientX - box.left) / box.width * WIDE
    const y = (event.clientY - box.top) / box.height * TALL
    return [
      limits[0] + (x - ROOM) / (WIDE - 2 * ROOM) * (limits[1] - limits[0]),
      limits[2] + (TALL - ROOM - y) / (TALL - 2 * ROOM) * (limits[3] - limits[2]),
    ]
  }
  const short = (value) => Number(value.toPrecision(3))
  const measure = () => {
    const [xs, ys] = [0, 1].map((one) => points.map((point) => point[one]))
    const low = Math.min(0, ...ys), high = Math.max(0, ...ys), room = 0.25 * (high - low || 1)
    limits = [Math.min(...xs), Math.max(...xs), low - room, high + room]
    if (limits[0] === limits[1]) { limits[1] += 1 }
  }
  const draw = () => {
    const zero = drawn("line", {
      x1: 0, x2: WIDE, y1: up(0), y2: up(0), stroke: "currentColor", opacity: 0.3,
    })
    const line = drawn("polyline", {
      points: points.map(([x, y]) => `${across(x)},${up(y)}`).join(" "),
      fill: "none", stroke: "#C24E00", "stroke-width": 2,
    })
    const dots = (fixed ? [] : points).map(([x, y], number) => {
      const dot = drawn("circle", {cx: across(x), cy: up(y), r: 6, fill: "#C24E00"})
      dot.append(drawn("title", {}, told([x, y].map(short))))
      dot.onpointerdown = (event) => {
        held = number
        moved = false
        picture.setPointerCapture(event.pointerId)
      }
      return dot
    })
    picture.replaceChildren(picture.firstChild, zero, line, ...dots)
  }
  picture.onpointermove = (event) => {
    if (held === null) { return }
    const [x, y] = place(event)
    // Times stay in order; ends move up and down alone, so that the interval stays whole.
    const inside = held > 0 && held < points.length - 1
    const [before, after] = [points[held - 1]?.[0], points[held + 1]?.[0]]
    const gap = 1e-3 * (limits[1] - limits[0])
    const time = inside ? Math.min(Math.max(x, before + gap), after - gap) : points[held][0]
    points = points.with(held, [short(time), short(y)])
    moved = true
    draw()
  }
  picture.onpointerup = () => {
    if (held === null) { return }
    held = null
    if (moved) { send(points) }
  }
  picture.ondblclick = (event) => {
    if (fixed) { return }
    const [x, y] = place(event)
    const near = points.findIndex(
      (point) => Math.hypot(across(point[0]) - across(x), up(point[1]) - up(y)) < ROOM)
    const after = points.findIndex((point) => point[0] > x)
    if (near >= 0) {
      if (points.length > 1) { send(points.toSpliced(near, 1)) }
    } else if (after > 0) { send(points.toSpliced(after, 0, [short(x), short(y)])) }
  }
  // Of a table that is too long to be changed here, some points are shown.
  const show = (wanted, isLong) => {
    if (held !== null) { return }
    fixed = isLong
    picture.firstChild.textContent = fixed ? "" : help
    points = wanted.map((point) => [...point])
    if (points.length) {
      measure()
      draw()
    }
  }
  return {picture, show, tell: (words) => { told = words }}
}
