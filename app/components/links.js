export function render({model, view}) {
  // Reports have shadow roots of their own. With a key the browser opens a page, as for any link.
  const follow = (event) => {
    const link = event.composedPath().find((one) => one.matches?.("a.run[href^='?']"))
    if (!link || event.ctrlKey || event.metaKey || event.shiftKey) { return }
    event.preventDefault()
    model.send_msg(link.getAttribute("href"))
  }
  document.addEventListener("click", follow)
  model.on("remove", () => document.removeEventListener("click", follow))
  return document.createElement("div")
}
