// Runs that were given names stay in this browser; what stands in its store may be anything.
const runs = (model, tell) => {
  const STORE = "slipfront-runs", MOST = 5
  const is_run = (one) =>
    ["name", "scene", "text"].every((part) => typeof one?.[part] === "string")
  const stored = () => {
    try {
      const all = JSON.parse(localStorage.getItem(STORE))
      return Array.isArray(all) ? all.filter(is_run).slice(0, MOST) : []
    } catch { return [] }
  }
  const store = (all) => {
    try { localStorage.setItem(STORE, JSON.stringify(all)) } catch {
      said.textContent =
        say("This browser keeps nothing for this page: save the settings (Share).")
    }
  }
  const others = (name) => stored().filter((one) => one.name !== name)
  const name = make("input", {maxLength: 40, size: 14, autocomplete: "off"})
  const said = make("p", {}), rows = make("div")
  said.setAttribute("role", "status")
  const form = make("form", {}, make("label", {}, say("Name"), " ", name),
    make("button", {className: "wide"}, say("Keep this run")))
  form.onsubmit = (event) => {
    event.preventDefault()
    if (others(name.value.trim()).length >= MOST) {
      said.textContent = say("{} runs at most: delete one first.", MOST)
    } else { tell("keep", name.value.trim()) }
  }
  const does = (text, title, act, more = {}) =>
    make("button", {type: "button", title, ariaLabel: `${text} ${title}`, onclick: act, ...more}, text)
  const row = (one) => {
    const go = (kind, value) => () => {
      rows.parentNode.hidePopover()
      tell(kind, value)
    }
    const is_of_scene = one.scene === model.scene
    return make("div", {className: "run"},
      make("b", {title: `${one.name} (${one.scene})`}, one.name),
      does(say("Open"), one.name, go("open", ["run.toml", one.text])),
      does(say("Compare"), is_of_scene ? one.name
        : say("{}: open it first, as its scene is {}", one.name, say(one.scene)),
        go("compare", one.text), {disabled: !is_of_scene}),
      does("✕", say("Delete {}", one.name), () => {
        store(others(one.name))
        show()
      }, {ariaLabel: say("Delete {}", one.name)}))
  }
  const show = () => rows.replaceChildren(...stored().map(row))
  model.on("kept", () => {
    const [name_of_it, scene, text] = model.kept
    said.textContent = ""
    name.value = ""
    store([...others(name_of_it).slice(0, MOST - 1), {name: name_of_it, scene, text}])
    show()
  })
  window.addEventListener("storage", show)
  model.on("remove", () => window.removeEventListener("storage", show))
  model.on("scene", show)
  show()
  const words = "Runs under names of their own stay in this browser, five at most."
  return menu("Runs", "Keep this run; open or compare with one that was kept.",
    make("p", {}, say(words)), form, said, rows)
}
