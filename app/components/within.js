// Ways through a page whose components have trees of their own.
const innermost = (root, find) => {
  const one = find(root)
  return one?.shadowRoot ? innermost(one.shadowRoot, find) ?? one : one
}
const beneath = (x, y) => innermost(document, (root) => {
  const one = root.elementFromPoint(x, y)
  return one === root.host ? null : one
})
const around = (one) => one ? [one, ...around(one.parentNode ?? one.host)] : []
const within = (root, wanted) => [...root.querySelectorAll("*")].flatMap((one) =>
  one.matches(wanted) ? [one] : one.shadowRoot ? within(one.shadowRoot, wanted) : [])
