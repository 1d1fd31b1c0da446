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
  button.onclick = () => {
    open(button.getAttribute("aria-expanded") !== "true")
    if (model.keeps) { keep() }
  }
  open(false)
  return button
}
