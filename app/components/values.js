// The value of a setting at a place on its slider, as round as one would type it.
function settled(item, place) {
  const value = item.log ? 10 ** place : place
  if (item.whole) { return Math.round(value) }
  if (item.log) { return Number(value.toPrecision(4)) }
  return Number((Math.round(value / item.step) * item.step).toPrecision(12))
}
// The unit that values of a size are read in, of steps `[name, factor, least]`, and its size in SI.
function step_of(size, steps) {
  const rounded = Number(Math.abs(size).toPrecision(3)) * (1 + 1e-9) || 1
  return steps.findLast(([, , least]) => least <= rounded)
}
const labelled = (label, unit) => unit ? `${label} (${unit})` : label
// Numbers go to and fro between units without what floating point would add to them.
const scaled = (value, factor) => Number((value / factor).toPrecision(15))
const in_si = (value, factor) => Number((value * factor).toPrecision(15))
function written(value, item) {
  const rounded = Number(value.toPrecision(item.log ? 4 : 6)), size = Math.abs(rounded)
  if (size === 0 || (size >= 1e-2 && size < 1e5)) { return rounded.toString() }
  return rounded.toExponential().replace("+", "")
}
// What somebody has typed, in SI: in the unit that stands there, or in one that is typed too.
// What is no number is refused as any other value, in the same words.
function typed_value(text, known, factor) {
  const plain = (unit) => unit.replace(/^u/, "µ").replace("²", "2").replace("³", "3").replace("^", "")
  const form = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(\D.*)?$/i
  const [, number, unit] = form.exec(text.trim().replace(",", ".").replace("−", "-")) ?? []
  if (number === undefined) { return text.trim() }
  const own = unit ? known.find(([name]) => plain(name) === plain(unit)) : ["", factor]
  return own ? in_si(Number(number), own[1]) : text.trim()
}
