function powers(value) {
  const size = Math.abs(value), plain = !size || size >= 1e-3 && size < 1e6
  const text = plain ? `${value}` : value.toExponential().replace("+", "")
  return text.replace("-", "−").replace(/e.*/, (e) =>
    "·10" + [...e.slice(1)].map((one) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[one] ?? "⁻").join(""))
}
