// Milliseconds that it stays where keys have moved it: what is shown meanwhile answers earlier ones.
const REST = 500

export function render({model}) {
  const text = make("output"), label = make("label", {}, make("span"), text)
  const range = make("input", {type: "range"})
  const button = make("button", {onclick: () => model.send_msg(null)})
  const root = make("div", {}, label, make("div", {className: "line"}, button, range))
  const show = () => {
    label.title = say(model.help)
    button.hidden = !model.plays
    button.textContent = model.playing ? "■" : "▶"
    button.title = button.ariaLabel = say(model.plays)
    range.ariaLabel = say(model.label)
    label.firstChild.textContent = say(model.label) + ": "
    text.textContent = range.ariaValueText = model.text
    range.min = model.start
    range.max = model.end
    follow()
  }
  const follow = () => { if (!held && !rests) { range.value = model.shown } }
  let held = false, rests = 0
  range.addEventListener("pointerdown", () => {
    held = true
    window.addEventListener("pointerup", () => { held = false }, {once: true})
  })
  range.addEventListener("input", () => {
    clearTimeout(rests)
    rests = setTimeout(() => {
      rests = 0
      follow()
    }, REST)
    model.send_msg(Number(range.value))
  })
  for (const name of ["label", "text", "start", "end", "shown", "playing"]) { model.on(name, show) }
  show()
  return root
}
