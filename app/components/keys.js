// What keeps a key to itself: letters choose in an open list, space and arrows move what has the focus.
const LISTS = "[role=option], [role=menuitem], [role=listbox], [role=menu], select"
const PRESSED = LISTS + ", button, summary, a, input:not([type=range]), [role=combobox]"
const MOVED = LISTS + ", input, [role=combobox], [role=slider], [role=radiogroup], [role=group]"
const ROW = "[role=group]:not([popover]), [role=toolbar]"
const SKIP = `position: fixed; left: 8px; top: -99px; z-index: 2000; padding: 8px 16px;
  border-radius: 4px; color: #fff; background: #0b3d66; font: 500 16px sans-serif`

export function render({model}) {
  const dialog = make("dialog", {ariaLabel: say("Keys and words")})
  dialog.innerHTML = `<h2>${say("Keys")}</h2><table></table>` +
    `<h2>${say("Words")}</h2><table class=words></table>`
  const row = (head, text) => make("tr", {}, make("th", {}, head), make("td", {}, text))
  const [keys, words] = dialog.querySelectorAll("table")
  keys.append(...model.keys.map(([, written, does]) => row(say(written), say(does))))
  const open = () => {
    words.replaceChildren(...model.terms.map(([[name], line]) => row(name, line)))
    dialog.showModal()
  }
  const close = glossary(model.terms)
  dialog.onclick = () => dialog.close()
  const button = make("button", {title: `${say("Keys and words")} (?).`, ariaLabel: say("Keys and words"),
    onclick: open}, "?")
  // Whoever has no mouse comes to the run without passing all settings.
  const skip = make("a", {href: "#", style: SKIP}, say("Go to the run"))
  skip.onfocus = () => { skip.style.top = "8px" }
  skip.onblur = () => { skip.style.top = "-99px" }
  skip.onclick = (event) => {
    event.preventDefault()
    const [row] = within(document, ".transport")
    const [first] = row ? within(row.shadowRoot ?? row, "button") : []
    const run = first?.checkVisibility() ? first : within(document, ".card")[0]
    run?.focus()
  }
  document.body.prepend(skip)
  // A row of buttons is one stop of Tab, which leaves it from any; arrows go from one to the next.
  const row_of = (one) => {
    const row = one.closest?.(ROW)
    const all = row ? [...row.querySelectorAll(":scope > button, :scope > .menu > button")] : []
    return all.includes(one) ? all : []
  }
  const go_on = (chosen, key, event) => {
    const by = {ArrowRight: 1, ArrowLeft: -1}[key]
    const all = row_of(chosen).filter((one) => !one.disabled && one.checkVisibility())
    if (!by) { return }
    event.preventDefault()
    all[(all.indexOf(chosen) + by + all.length) % all.length].focus()
  }
  const step_out = (event) => {
    if (event.key !== "Tab") { return }
    const chosen = event.composedPath()[0]
    const others = row_of(chosen).filter((one) => one !== chosen)
    const were = others.map((one) => one.tabIndex)
    others.forEach((one) => { one.tabIndex = -1 })
    // By then the focus has gone on: whatever is disabled or hidden later, the row can be reached.
    setTimeout(() => others.forEach((one, place) => { one.tabIndex = were[place] }))
  }
  const out = say("Leave the presenter's view (p).")
  const leave = make("button", {title: out, ariaLabel: out, onclick: () => model.send_msg("p")}, "✕")
  const show = () => { leave.hidden = !model.presents }
  model.on("presents", show)
  show()
  const names = new Set([...model.keys.map(([name]) => name), ...model.own])
  const press = (event) => {
    if (event.altKey || !model.hears) { return }
    const commands = event.ctrlKey || event.metaKey
    const key = commands ? event.key.toLowerCase() : event.key
    const shifts = event.shiftKey && (commands || key.startsWith("Arrow"))
    const name = (commands ? "Ctrl+" : "") + (shifts ? "Shift+" : "") + key
    if (!names.has(name) || event.repeat && !key.startsWith("Arrow")) { return }
    const typed = event.composedPath()[0]
    const writes = typed.tagName === "INPUT" && !["range", "checkbox", "radio"].includes(typed.type)
    if (writes || typed.tagName === "TEXTAREA" || typed.isContentEditable) { return }
    if (key.startsWith("Arrow") && row_of(typed).length) { return go_on(typed, key, event) }
    const keeps = key.startsWith("Arrow") ? MOVED : key === " " ? PRESSED : LISTS
    if (!commands && typed.closest && typed.closest(keeps) || dialog.open) { return }
    event.preventDefault()
    if (name === "?") { open() }
    else if (model.own.includes(name)) {
      document.dispatchEvent(new CustomEvent("plot-key", {detail: name}))
    } else { model.send_msg(name) }
  }
  document.addEventListener("keydown", press)
  document.addEventListener("keydown", step_out)
  model.on("remove", () => {
    close()
    skip.remove()
    document.removeEventListener("keydown", press)
    document.removeEventListener("keydown", step_out)
  })
  return make("div", {className: "corner"}, button, leave, dialog)
}
