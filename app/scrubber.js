export function render({model, el}) {
  const label = document.createElement("label")
  const text = document.createElement("output")
  const range = document.createElement("input")
  range.type = "range"
  label.append(document.createElement("span"), text, range)
  const show = () => {
    label.title = model.help
    range.ariaLabel = model.label
    label.firstChild.textContent = model.label + ": "
    text.textContent = model.text
    range.min = model.start
    range.max = model.end
    if (!held) { range.value = model.shown }
  }
  let held = false
  range.addEventListener("pointerdown", () => {
    held = true
    window.addEventListener("pointerup", () => { held = false }, {once: true})
  })
  range.addEventListener("input", () => { model.wanted = Number(range.value) })
  for (const name of ["label", "text", "start", "end", "shown"]) { model.on(name, show) }
  show()
  return label
}
