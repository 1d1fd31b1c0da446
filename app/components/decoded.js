// Files that are read: their bytes as text.
const decoded = (bytes) => {
  try { return new TextDecoder("utf-8", {fatal: true}).decode(bytes) } catch {}
  // Spreadsheets write letters as old Windows did; no text has zeros.
  const isText = !new Uint8Array(bytes).includes(0)
  return isText ? new TextDecoder("windows-1252").decode(bytes) : null
}
