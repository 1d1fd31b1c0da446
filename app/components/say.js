// Words of the page in its language, which its head has; without one they are English.
const say = (text, ...parts) => {
  const words = globalThis.slipfrontWords ?? {}
  const [, title, unit] = /^(.*)( \([^()]*\))$/.exec(text) ?? []
  const told = words[text] ?? (title in words ? words[title] + unit : text)
  let next = 0
  return parts.length ? told.replace(/\{(\d*)\}/g, (_, at) => parts[at || next++]) : told
}
