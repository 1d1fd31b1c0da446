export function render({model}) {
  const tell = (kind, value = "") => model.send_msg({kind, value})
  const wide = (text, title, onclick) =>
    make("button", {type: "button", className: "wide", title: say(title), onclick}, say(text))
  const upload = make("input", {type: "file", accept: ".toml,.csv"})
  upload.onchange = async () => {
    const [file] = upload.files
    if (file) { tell("open", [file.name, decoded(await file.arrayBuffer())]) }
    upload.value = ""
  }
  const share = menu("Share", "The link to what stands here; settings to and from a file.",
    wide("Copy link", "The address of this page: its settings and what you look at.",
      () => tell("link")),
    wide("Save settings", "A file that this page and the command line read.",
      () => tell("save")),
    make("label", {}, say("Open settings (.toml) or a load path (.csv)"), upload),
    wide("Defaults", "Bring all settings of this scene back.", () => tell("defaults")))
  const lead = wide("Start a class", "Others see what you see.", () => {
    lead.parentNode.hidePopover()
    tell("class")
  })
  // The page of that class is another one, which says if there is none.
  const code = make("input", {name: "class", required: true, size: 8, maxLength: 12,
    autocomplete: "off", autocapitalize: "characters"})
  const join = make("form", {action: location.pathname},
    make("label", {}, say("Code of a class"), " ", code),
    make("button", {className: "wide"}, say("Join")))
  const lesson = menu("Class", "Lead a class, or join one by its code.",
    make("p", {}, say("Whoever joins by its code sees what you see.")), lead, join)
  const present = action("Present", "For a projector (p).", {onclick: () => tell("present")})
  const steps = [
    action("Undo", "Take back the last change (Ctrl Z).", {onclick: () => tell("undo")}),
    action("Redo", "Make it again (Ctrl Shift Z).", {onclick: () => tell("redo")}),
  ]
  const show = () => steps.forEach((one, place) => {
    one.classList.add("step")
    one.disabled = !model.steps[place]
  })
  model.on("steps", show)
  show()
  model.on("file", () =>
    save("slipfront.toml", new Blob([model.file[0]], {type: "application/toml"})))
  const bar = make("div", {className: "actions", ariaLabel: say("Page")},
    ...steps, runs(model, tell), lesson, present, share)
  bar.setAttribute("role", "toolbar")
  return bar
}
