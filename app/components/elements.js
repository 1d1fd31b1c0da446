// Elements of HTML and of pictures, and files to be saved.
const SVG = "http://www.w3.org/2000/svg"
const make = (tag, more = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), more)
  made.append(...children)
  return made
}
const drawn = (tag, attributes = {}, text = "") => {
  const made = document.createElementNS(SVG, tag)
  for (const [name, value] of Object.entries(attributes)) { made.setAttribute(name, value) }
  made.textContent = text
  return made
}
const save = (name, blob) => {
  const href = URL.createObjectURL(blob)
  make("a", {href, download: name}).click()
  setTimeout(() => URL.revokeObjectURL(href), 1e4)
}
