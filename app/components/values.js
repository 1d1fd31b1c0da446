// The value of a setting at a place on its slider, as round as one would type it.
function settled(item, place) {
  const value = item.log ? 10 ** place : place
  if (item.whole) { return Math.round(value) }
  if (item.log) { return Number(value.toPrecision(4)) }
  return Number((Math.round(value / item.step) * item.step).toPrecision(12))
}
// A value with the prefix of its unit that one reads; the unit may have one already.
const FACTORS = {n: 1e-9, µ: 1e-6, m: 1e-3, "": 1, k: 1e3, M: 1e6, G: 1e9}
function measured(value, unit) {
  const [, prefix = "", base = ""] = /^([nµmkMG]?)((?:m|N|Pa|J)(?:\W.*)?)$/.exec(unit) ?? []
  const plain = Number(value.toPrecision(3)), size = Math.abs(value) * FACTORS[prefix]
  if (!base || !size || size < 1e-9 || size >= 1e13) { return `${plain} ${unit}`.trim() }
  const [best, factor] = Object.entries(FACTORS).findLast(([, one]) => size >= 0.1 * one) ?? ["n", 1e-9]
  return `${Number((value * FACTORS[prefix] / factor).toPrecision(3))} ${best}${base}`
}
function written(value, item) {
  const rounded = Number(value.toPrecision(item.log ? 4 : 6)), size = Math.abs(rounded)
  if (size === 0 || (size >= 1e-2 && size < 1e5)) { return rounded.toString() }
  return rounded.toExponential().replace("+", "")
}
