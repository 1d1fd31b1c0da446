// Pictures as bytes, as `app.wire.block` packs them, and what they set.
const floats = (buffer, at, count) => new Float32Array(buffer, at, count)
const corners = (buffer, base, [c, n, p, m, each]) => {
  const corner = new Uint16Array(buffer, base + c, n), place = floats(buffer, base + p, m)
  const xs = [], ys = []
  for (let i = 0; i < n; i += each) {
    const x = new Float32Array(each), y = new Float32Array(each)
    for (let j = 0; j < each; j++) {
      x[j] = place[2 * corner[i + j]]
      y[j] = place[2 * corner[i + j] + 1]
    }
    xs.push(x)
    ys.push(y)
  }
  return {xs, ys}
}
const image = (buffer, base, [at, rows, columns, dtype]) => {
  const kind = dtype === "uint8" ? Uint8Array : Float32Array
  const {ndarray} = Bokeh.require("core/util/ndarray")
  const numbers = new kind(buffer, base + at, rows * columns)
  return [ndarray(numbers, {dtype, shape: [rows, columns]})]
}
const read = (buffer, base, settings) => {
  const values = {}
  for (const [key, value] of Object.entries(settings)) {
    const where = value !== null && typeof value === "object" && !Array.isArray(value)
    const cut = ([at, count]) => floats(buffer, base + at, count)
    if (!where) { values[key] = value }
    else if (value.floats) { values[key] = cut(value.floats) }
    else if (value.lines) { values[key] = value.lines.map(cut) }
    else if (value.image) { values[key] = image(buffer, base, value.image) }
    else { Object.assign(values, corners(buffer, base, value.quads)) }
  }
  return values
}
// What models are set to, by their names.
const unpacked = (buffer) => {
  const length = new DataView(buffer).getUint32(0, true)
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)))
  return Object.fromEntries(Object.entries(header).map(([name, part]) =>
    [name, read(buffer, 4 + length + part.at, part.set)]))
}
const put = (one, values) =>
  one.setv(one.type === "ColumnDataSource" ? {data: values} : values, {sync: false})
