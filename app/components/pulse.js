const WAIT = 8000, PATIENCE = 10000, BEAT = 2000, UNHEARD = 3
export function render({model, view}) {
  const found = new Map(), {page} = model
  const tell = (kind, number) => {
    // A socket that is being opened refuses to send.
    if (!closed) { model.send_msg([kind, page, number]) }
  }
  const named = (name) => {
    const kept = found.get(name)
    if (kept && kept.document) { return kept }
    found.clear()
    // Every figure has a document of its own.
    for (const one of Bokeh.documents.flatMap(({_all_models}) => [..._all_models.values()])) {
      // Panes of Panel keep their names to themselves, but not their tags.
      for (const own of [one.name, ...one.tags]) { found.set(own, one) }
    }
    return found.get(name)
  }
  const paint = (buffer) => {
    for (const [name, values] of Object.entries(unpacked(buffer))) {
      const one = named(name)
      if (!one) { continue }
      // An axis that somebody has zoomed (`lens.js`) stays where it is.
      if (one.held) { Object.assign(one.held, values) } else { put(one, values) }
    }
  }
  // The whole line changes many times a second: only what the run has come to is spoken.
  const spoken = document.createElement("span")
  spoken.setAttribute("role", "status")
  Object.assign(spoken.style, {position: "absolute", width: "1px", height: "1px",
    overflow: "hidden", clipPath: "inset(50%)", whiteSpace: "nowrap"})
  const plain = document.createElement("textarea")
  let state = ""
  const speak = () => {
    plain.innerHTML = named("status")?.text ?? ""
    const now = /<b>(.*?)<.b>/.exec(plain.value)?.[1] ?? ""
    if (now !== state && !/^(running|follows)/.test(now)) {
      const [line] = plain.value.split('<span class="asks"')
      spoken.textContent = line.replaceAll(/<[^>]*>/g, " ")
    }
    state = now
  }
  // A socket may close, or, where a network only falls silent, stay open for minutes.
  let lost = false, losses = 0, gone = false, closed = null, beats = 0, answered = 0
  // Only its own server knows a page, and for as long as it is open; another one makes it anew.
  const reach = async () => {
    const asked = `${location.pathname}?page=${page}`
    const answer = await fetch(asked, {method: "HEAD", signal: AbortSignal.timeout(WAIT)})
    const is_known = answer.status !== 410
    if (!is_known) { location.replace(address()) }
    // A proxy may answer for a server that is gone.
    else if (!answer.ok) { throw new Error(answer.statusText) }
    return is_known
  }
  const come_back = async (loss) => {
    // Another loss has its own way back.
    const is_lost = () => lost && !gone && loss === losses
    try {
      // A server that has much to do takes its time, to answer here as to be heard again; and a
      // socket that had fallen silent may close just as the network comes back.
      for (let waited = 0; waited < PATIENCE; waited += BEAT) {
        if (!is_lost() || !await reach() || !is_lost()) { return }
        closed?.reconnect()
        await new Promise((done) => setTimeout(done, BEAT))
      }
      if (is_lost()) { location.replace(address()) }
    } catch { setTimeout(() => come_back(loss), 1000) }
  }
  const lose = () => {
    if (gone) { return }
    const text = "&lt;b&gt;not connected&lt;/b&gt;, trying again"
    named("status").setv({text}, {sync: false})
    if (!lost) {
      lost = true
      come_back(++losses)
    }
  }
  const timer = setInterval(() => {
    if (beats - answered >= UNHEARD) { lose() }
    if (!closed) { tell("beat", ++beats) }
  }, BEAT)
  const {document: own} = view.model
  // Bokeh, connected again, puts a whole page in place of this one, as it was first asked for.
  own.replace_with_json = () => {}
  own.on_event("connection_lost", (_, event) => {
    closed = event
    // Bokeh would read on in the message in the midst of which the socket broke.
    const socket = event.connection.deref()
    socket._receiver = new socket._receiver.constructor()
    lose()
  })
  // Whatever comes is a sign of life; what was missed meanwhile is asked for.
  const find_again = () => {
    closed = null
    answered = beats
    if (!lost) { return }
    lost = false
    tell("beat", -++beats)
  }
  own.on_event("client_reconnected", find_again)
  model.on("heard", find_again)
  model.on("msg:custom", ([number, picture]) => {
    find_again()
    paint(picture)
    speak()
    requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(() => {
      tell("painted", number)
    })))
  })
  // A page that is loaded again leads the class that it led; a link to it does not.
  const LED = "slipfront-class"
  model.on("leads", () => {
    try { sessionStorage.setItem(LED, model.leads) } catch {}
  })
  model.on("recalls", () => {
    let led = ""
    try { led = sessionStorage.getItem(LED) } catch {}
    if (led) { tell("leads", led) }
  })
  if (window.innerWidth < 640) { model.phone = true }
  if (window.innerWidth < 900) { model.narrow = true }
  // The address bar follows, so that a reload comes back; browsers refuse to do it very often.
  // It names a theme only where that is not the system's, which whoever opens it has too.
  const {dataset} = document.documentElement, dark = matchMedia("(prefers-color-scheme: dark)")
  const address = () => dataset.theme === (dark.matches ? "dark" : "light")
    ? model.query : `${model.query}&theme=${dataset.theme}`
  let due = 0, isNew = false
  const follow = () => {
    if (!model.query) { return }
    history[isNew ? "pushState" : "replaceState"](null, "", address())
    isNew = false
  }
  const follow_soon = () => {
    clearTimeout(due)
    due = setTimeout(follow, 300)
  }
  const themes = new MutationObserver(follow_soon)
  themes.observe(document.documentElement, {attributeFilter: ["data-theme"]})
  model.on("query", follow_soon)
  model.on("entries", () => {
    isNew = true
    follow_soon()
  })
  const went = () => {
    clearTimeout(due)
    isNew = false
    tell("went", location.search)
  }
  window.addEventListener("popstate", went)
  model.on("copy", () => {
    follow()
    const count = model.copy, wrote = navigator.clipboard?.writeText(location.href)
    // Without https there is no clipboard.
    const done = wrote ?? Promise.reject()
    done.then(() => { model.copied = count }, () => { model.copied = -count })
  })
  // What moves by itself stops at the first touch of anything.
  const touches = ["pointerdown", "keydown", "wheel"], options = {capture: true, passive: true}
  const rest = () => {
    for (const kind of touches) { window.removeEventListener(kind, rest, options) }
    model.calm = true
  }
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) {
    for (const kind of touches) { window.addEventListener(kind, rest, options) }
    model.calm = false
  }
  const look = () => { model.hidden = document.visibilityState === "hidden" }
  document.addEventListener("visibilitychange", look)
  model.on("remove", () => {
    gone = true
    clearInterval(timer)
    clearTimeout(due)
    themes.disconnect()
    rest()
    window.removeEventListener("popstate", went)
    document.removeEventListener("visibilitychange", look)
  })
  look()
  return spoken
}
