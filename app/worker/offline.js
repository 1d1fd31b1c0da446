// The program of a run that was taken away: one slider over its instants, and nothing to load.
const decoded = (text) => Uint8Array.from(atob(text), (one) => one.charCodeAt(0)).buffer
const begin = ({pictures, words}) => {
  const found = new Map(Bokeh.documents.flatMap(({_all_models}) => [..._all_models.values()])
    .map((one) => [one.name, one]))
  // A picture brings what is other than in the one before.
  const all = []
  for (const picture of pictures) {
    all.push({...all.at(-1), ...unpacked(decoded(picture))})
  }
  const slider = document.querySelector("input"), seen = {}
  const show = () => {
    const at = Number(slider.value)
    for (const [name, values] of Object.entries(all[at])) {
      if (seen[name] === values) { continue }
      seen[name] = values
      const title = document.getElementById(name), one = found.get(name)
      if (title) { title.innerHTML = values.text } else if (one) { put(one, values) }
    }
    for (const [name, text] of Object.entries(words[at])) {
      document.getElementById(name).innerHTML = text
    }
  }
  slider.oninput = show
  show()
}
const wait = () => {
  if (Bokeh.documents[0]?.is_idle) { begin(run) } else { requestAnimationFrame(wait) }
}
wait()
