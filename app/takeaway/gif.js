// Encodes pictures of equal size as an animated GIF (GIF89a), which no browser does by itself.
const gif = (() => {
  const COLORS = 256, LARGEST = 4096
  // Five bits of each colour tell apart what a plot needs.
  const key = (data, at) => data[at] >> 3 << 10 | data[at + 1] >> 3 << 5 | data[at + 2] >> 3
  const parts = (one) => [one >> 10, one >> 5 & 31, one & 31].map((part) => part * 255 / 31 | 0)
  const palette = (frames) => {
    const counts = new Map()
    for (const {data} of frames) {
      for (let at = 0; at < data.length; at += 4) {
        const one = key(data, at)
        counts.set(one, (counts.get(one) ?? 0) + 1)
      }
    }
    const kept = [...counts].sort((a, b) => b[1] - a[1]).slice(0, COLORS).map(([one]) => one)
    const colors = kept.map(parts), places = new Map(kept.map((one, place) => [one, place]))
    const nearest = (one) => {
      const distances = colors.map((color) =>
        parts(one).reduce((sum, part, i) => sum + (part - color[i]) ** 2, 0))
      return distances.indexOf(Math.min(...distances))
    }
    for (const one of counts.keys()) { places.has(one) || places.set(one, nearest(one)) }
    return {colors, places}
  }
  // Lempel, Ziv and Welch: codes grow with the table, which begins anew when it is full.
  const packed = (pixels) => {
    const bytes = [], clear = COLORS, end = COLORS + 1
    let bits = 0, held = 0, size, next, table
    const put = (code) => {
      held |= code << bits
      for (bits += size; bits >= 8; bits -= 8) {
        bytes.push(held & 255)
        held >>>= 8
      }
    }
    const begin = () => {
      if (size) { put(clear) }
      size = 9
      next = end + 1
      table = new Map()
    }
    size = 9
    begin()
    let known = pixels[0]
    for (let at = 1; at < pixels.length; at++) {
      const longer = known << 8 | pixels[at], code = table.get(longer)
      if (code !== undefined) {
        known = code
        continue
      }
      put(known)
      known = pixels[at]
      if (next === LARGEST) {
        begin()
        continue
      }
      if (next === 1 << size) { size += 1 }
      table.set(longer, next++)
    }
    put(known)
    put(end)
    if (bits) { bytes.push(held & 255) }
    return bytes
  }
  const short = (value) => [value & 255, value >> 8]
  return (frames, width, height, hundredths) => {
    const {colors, places} = palette(frames)
    const map = [...colors, ...Array(COLORS - colors.length).fill([0, 0, 0])].flat()
    const size = [...short(width), ...short(height)]
    const chunks = [new TextEncoder().encode("GIF89a"), [...size, 0xf7, 0, 0, ...map],
      [0x21, 0xff, 11], new TextEncoder().encode("NETSCAPE2.0"), [3, 1, 0, 0, 0]]
    for (const {data} of frames) {
      const pixels = new Uint8Array(width * height)
      for (let i = 0; i < pixels.length; i++) { pixels[i] = places.get(key(data, 4 * i)) }
      chunks.push([0x21, 0xf9, 4, 4, ...short(hundredths), 0, 0, 0x2c, 0, 0, 0, 0, ...size, 0, 8])
      const bytes = packed(pixels)
      for (let at = 0; at < bytes.length; at += 255) {
        const block = bytes.slice(at, at + 255)
        chunks.push([block.length, ...block])
      }
      chunks.push([0])
    }
    chunks.push([0x3b])
    return new Blob(chunks.map((one) => new Uint8Array(one)), {type: "image/gif"})
  }
})()
