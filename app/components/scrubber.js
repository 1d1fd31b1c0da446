export function render({model}) {
  const label = document.createElement("label")
  const text = document.createElement("output")
  const range = document.createElement("input")
  range.type = "range"
  const button = document.createElement("button")
  button.onclick = () => model.send_msg(null)
  label.append(document.createElement("span"), text)
  const line = document.createElement("div"), root = document.createElement("div")
  line.className = "line"
  line.append(button, range)
  root.append(label, line)
  const show = () => {
    label.title = model.help
    button.hidden = !model.plays
    button.textContent = model.playing ? "■" : "▶"
    button.title = button.ariaLabel = model.plays
    range.ariaLabel = model.label
    label.firstChild.textContent = model.label + ": "
    text.textContent = range.ariaValueText = model.text
    range.min = model.start
    range.max = model.end
    if (!held) { range.value = model.shown }
  }
  let held = false
  range.addEventListener("pointerdown", () => {
    held = true
    window.addEventListener("pointerup", () => { held = false }, {once: true})
  })
  range.addEventListener("input", () => model.send_msg(Number(range.value)))
  for (const name of ["label", "text", "start", "end", "shown", "playing"]) { model.on(name, show) }
  show()
  return root
}
