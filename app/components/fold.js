export function render({model, view}) {
  const button = document.createElement("button")
  button.type = "button"
  button.textContent = model.label
  const open = (is) => {
    button.setAttribute("aria-expanded", is)
    view.el.nextElementSibling?.classList.toggle("unfolded", is)
  }
  // The one that is looked at: the first of which more than half is below the header.
  const keep = () => {
    const seen = within(document, `.${model.keeps}`).find((one) => {
      const {top, bottom} = one.getBoundingClientRect()
      return top + bottom > 112
    })
    seen?.scrollIntoView({block: "start"})
  }
  const {kept_as: name} = model
  button.onclick = () => {
    const is = button.getAttribute("aria-expanded") !== "true"
    open(is)
    if (model.keeps) { keep() }
    try { if (name) { localStorage.setItem(name, is) } } catch {}
  }
  let was = null
  try { was = name && localStorage.getItem(name) } catch {}
  // What stands behind it is built after it.
  requestAnimationFrame(() => open(was === "true"))
  return button
}
