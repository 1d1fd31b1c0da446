// Pictures as bytes, as `app.wire.block` packs them, and what they set.
const floats = (buffer, at, count) => new Float32Array(buffer, at, count)
const places = (buffer, base, [first, step, lines]) => lines.map(([at, count]) => {
  const steps = new Uint16Array(buffer, base + at, count), found = new Float32Array(count)
  for (let i = 0; i < count; i++) {
    found[i] = steps[i] === 65535 ? NaN : first + step * steps[i]
  }
  return found
})
const corners = (buffer, base, [[at, count, each], ...axes]) => {
  const corner = new Uint16Array(buffer, base + at, count * each)
  const [xs, ys] = axes.map(({places: told}) => {
    const [place] = places(buffer, base, told), found = []
    for (let i = 0; i < corner.length; i += each) {
      const one = new Float32Array(each)
      for (let j = 0; j < each; j++) { one[j] = place[corner[i + j]] }
      found.push(one)
    }
    return found
  })
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
    else if (value.places) { values[key] = places(buffer, base, value.places) }
    else if (value.image) { values[key] = image(buffer, base, value.image) }
    else { Object.assign(values, corners(buffer, base, value.quads)) }
  }
  return values
}
// The numbers of a model: as they were, but for the words that are new.
const renewed = (buffer, at, size, before) => {
  const count = size >> 2, found = new Uint32Array(count), aligned = 8 * ((count + 63) >> 6)
  const mask = new Uint8Array(buffer, at, aligned), news = new Uint32Array(buffer, at + aligned)
  found.set(new Uint32Array(before).subarray(0, count))
  for (let i = 0, next = 0; i < count; i++) {
    if (mask[i >> 3] >> (i & 7) & 1) { found[i] = news[next++] }
  }
  return found.buffer
}
// What models are set to, by their names; what they were, they may keep in part.
const known = new Map()
const unpacked = (buffer) => {
  const length = new DataView(buffer).getUint32(0, true), first = 4 + length
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)))
  return Object.fromEntries(Object.entries(header).map(([name, {at, size, set, since}]) => {
    const before = since && known.get(name)
    const numbers = before ? renewed(buffer, first + at, size, before.numbers)
      : buffer.slice(first + at, first + at + size)
    const now = {numbers, set: {...before?.set, ...set}}
    known.set(name, now)
    return [name, read(now.numbers, 0, now.set)]
  }))
}
const put = (one, values) =>
  one.setv(one.type === "ColumnDataSource" ? {data: values} : values, {sync: false})
