// The value of a setting at a place on its slider, as round as one would type it.
function settled(item, place) {
  const value = item.log ? 10 ** place : place
  if (item.whole) { return Math.round(value) }
  if (item.log) { return Number(value.toPrecision(4)) }
  return Number((Math.round(value / item.step) * item.step).toPrecision(12))
}
function written(value, item) {
  const rounded = Number(value.toPrecision(item.log ? 4 : 6)), size = Math.abs(rounded)
  if (size === 0 || (size >= 1e-2 && size < 1e5)) { return rounded.toString() }
  return rounded.toExponential().replace("+", "")
}
