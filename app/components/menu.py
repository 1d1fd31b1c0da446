"""How buttons of the header look, and what opens below one (`menu.js`)."""

from __future__ import annotations

STYLE = """
.actions { display: flex; gap: 2px; }
.action { display: flex; align-items: center; gap: 6px; width: auto; height: 36px; padding: 0 10px;
  font-size: 15px; white-space: nowrap; color: #fff; border: 0; }
.action:hover { background: rgb(0 0 0 / 22%); }
.action:focus-visible { outline: 2px solid currentColor; outline-offset: -2px; }
.action svg { width: 20px; height: 20px; fill: none; stroke: currentColor; stroke-width: 2;
  stroke-linejoin: round; stroke-linecap: round; }
.action:disabled { opacity: 0.4; cursor: default; background: none; }
.step { padding: 0 6px; }
.step span { display: none; }
.pane { position: fixed; inset: auto; box-sizing: border-box; width: 300px; padding: 10px 16px 14px;
  border: 1px solid color-mix(in srgb, currentColor 25%, transparent); border-radius: 8px;
  color: var(--mui-palette-text-primary);
  background: var(--mui-palette-background-paper); box-shadow: 0 4px 24px rgb(0 0 0 / 40%); }
.pane p { margin: 4px 0 8px; }
.pane label { margin: 6px 0; }
.pane form { display: flex; align-items: end; gap: 8px; margin-top: 4px; }
.pane form .wide { margin: 0; }
.pane [name=class] { text-transform: uppercase; }
.run { display: flex; align-items: center; gap: 6px; margin: 4px 0; }
.run b { flex: 1; min-width: 0; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
.run button { width: auto; padding: 3px 8px; }
.run button:disabled { opacity: 0.4; cursor: default; }
.pane input:not([type=file]) { display: block; padding: 4px 6px; font: inherit; color: inherit;
  background: transparent; border-radius: 4px;
  border: 1px solid color-mix(in srgb, currentColor 30%, transparent); }
@media (min-width: 641px) and (max-width: 1279px) { .action span { display: none; } }
@media (min-width: 641px) and (max-width: 799px) { .step { display: none; } }
@media (max-width: 899px) { .action { padding: 0 5px; } }
@media (max-width: 640px) {
  .action { color: inherit; font-size: 14px; }
  .action:hover { background: none; }
  .action:not(.step) svg { display: none; }
  .pane { inset: auto 8px 52px !important; width: auto; }
}
"""
