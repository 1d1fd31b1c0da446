// Iterations over k, small, beside the curves that they are counted of; a button that leads on.
const bathtub = (plot, open) => {
  const picture = drawn("svg", {"aria-hidden": true})
  const button = make("button", {type: "button", className: "bathtub", hidden: true, onclick: open},
    picture)
  const LEFT = 8, TOP = 18, BELOW = 16
  let shown = []
  const draw = () => {
    const [points = [], now, near] = shown
    button.hidden = !points.length
    if (!points.length || plot.properties.inner_width.is_unset) { return }
    const wide = Math.round(0.34 * plot.inner_width), tall = plot.outer_height - 8
    Object.assign(button.style, {width: `${wide}px`, height: `${tall}px`})
    const of = (values) => [Math.log(Math.min(...values)), Math.log(Math.max(...values))]
    const scale = (values, from, to) => {
      const [low, high] = of(values)
      return (value) => from + (to - from) * (Math.log(value) - low) / (high - low || 1)
    }
    const ks = points.map(([k]) => k), counts = points.map(([, count]) => Math.max(count, 1))
    const across = scale(ks, LEFT + 4, wide - 14), up = scale(counts, tall - BELOW - 6, TOP + 14)
    const places = points.map(([k], i) => [across(k), up(counts[i])])
    const words = (x, y, text, anchor) => drawn("text", {x, y, "text-anchor": anchor}, text)
    const least = counts.indexOf(Math.min(...counts)), last = points.length - 1
    const named = [...new Set([0, least, last])]
    picture.replaceChildren(
      words(wide / 2, 12, say("iterations to {}", near), "middle"),
      words(LEFT, tall - 4, `${ks[0]}`, "start"),
      words(wide / 2, tall - 4, "k ×", "middle"),
      words(wide - 8, tall - 4, `${ks[last]}`, "end"),
      drawn("polyline", {points: places.map(String).join(" ")}),
      ...points.map(([k, , is_enough], i) => drawn("circle", {
        cx: places[i][0], cy: places[i][1], r: k === now ? 4.5 : 3,
        class: `${is_enough ? "" : "short "}${k === now ? "now" : ""}`})),
      ...named.map((i) => words(places[i][0], places[i][1] - 7,
        `${points[i][2] ? "" : "> "}${counts[i]}`, i === 0 ? "start" : i === last ? "end" : "middle")))
    const told = points.map(([k, count, is_enough]) =>
      `k × ${k}: ${is_enough ? count : say("more than {}", count)}`)
    button.title = say("Ask for the whole curve, in What if.")
    button.ariaLabel = `${say("Iterations to {}", near)}: ${told.join(", ")}. ${button.title}`
  }
  plot.properties.inner_width.change.connect(draw)
  plot.properties.inner_height.change.connect(draw)
  const show = (found) => {
    shown = found
    draw()
  }
  return {button, show}
}
