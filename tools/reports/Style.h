#pragma once

/// How a page looks: one column, light or dark as the reader's system is, black on white when printed.
namespace lamella::reports
{

inline constexpr const char* style = R"(:root {
  --paper: #ffffff; --ink: #1c2126; --soft: #5b6570; --line: #d5dae0; --fill: #f4f6f8; --link: #1f5fae;
  --warn: #8a4b00; --warnfill: #fff6e5;
  --c0: #1f5fae; --c1: #c2410c; --c2: #15803d; --c3: #7e22ce; --c4: #b45309; --c5: #0e7490; --c6: #be185d; --c7: #4d5560;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #14181c; --ink: #e4e8ec; --soft: #9aa5b1; --line: #343c45; --fill: #1d2329; --link: #7fb3f0;
    --warn: #f2b866; --warnfill: #2c2315;
    --c0: #7fb3f0; --c1: #ff9b66; --c2: #6fd08c; --c3: #c9a2f5; --c4: #e5b05c; --c5: #62c9dd; --c6: #f28cb8; --c7: #b4bdc7;
  }
}
* { box-sizing: border-box; }
html { color-scheme: light dark; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.5 system-ui, "Segoe UI", "Noto Sans", sans-serif; }
main { max-width: 62rem; margin: 0 auto; padding: 1.5rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0.5rem 0 0.75rem; }
h2 { font-size: 1.35rem; margin: 2.6rem 0 0.6rem; padding-top: 0.6rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.1rem; margin: 1.8rem 0 0.4rem; }
h4 { font-size: 1rem; margin: 1.2rem 0 0.4rem; }
p, ul, ol { margin: 0.5rem 0; }
a { color: var(--link); }
code, pre { font: 0.88em/1.45 ui-monospace, "DejaVu Sans Mono", monospace; }
pre { background: var(--fill); border: 1px solid var(--line); padding: 0.7rem 0.9rem; overflow-x: auto; white-space: pre-wrap;
  overflow-wrap: anywhere; }
code { background: var(--fill); padding: 0.05em 0.25em; }
pre code { background: none; padding: 0; }
.about, figcaption, .note { color: var(--soft); font-size: 0.92rem; }
nav ol, nav ul { columns: 2 20rem; padding-left: 1.4rem; }
nav li { break-inside: avoid; }
nav .no { color: var(--soft); }
figure { margin: 1.1rem 0; }
figure img { display: block; max-width: 100%; max-height: 34rem; width: auto; height: auto; background: #ffffff; border: 1px solid var(--line); padding: 0.3rem; }
figure svg { display: block; width: 100%; max-width: 42rem; height: auto; color: var(--ink); }
figcaption { margin-top: 0.35rem; }
.grid { display: grid; gap: 0.9rem 0.7rem; grid-template-columns: repeat(auto-fill, minmax(10rem, 1fr)); align-items: end; margin: 0.9rem 0; }
.c1 { grid-template-columns: minmax(0, 40rem); }
.c2 { grid-template-columns: repeat(2, minmax(0, 1fr)); }
.c3 { grid-template-columns: repeat(3, minmax(0, 1fr)); }
.c4 { grid-template-columns: repeat(4, minmax(0, 1fr)); }
.c5 { grid-template-columns: repeat(5, minmax(0, 1fr)); }
.c6 { grid-template-columns: repeat(6, minmax(0, 1fr)); }
@media (max-width: 40rem) { .grid { grid-template-columns: repeat(2, minmax(0, 1fr)); } }
.grid figure { margin: 0; }
.grid img { width: 100%; max-height: 22rem; object-fit: contain; padding: 0; }
.missing { border: 1px dashed var(--warn); color: var(--warn); background: var(--warnfill); padding: 0.6rem 0.9rem; margin: 1rem 0; }
.problems { border: 1px solid var(--warn); background: var(--warnfill); padding: 0.4rem 1rem; margin: 1rem 0; }
.discussion { border-left: 3px solid var(--line); padding-left: 1rem; margin: 1rem 0; }
.table { overflow-x: auto; margin: 0.9rem 0; }
table { border-collapse: collapse; font-size: 0.92rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--soft); padding-bottom: 0.3rem; }
th, td { text-align: left; vertical-align: top; padding: 0.25rem 0.8rem 0.25rem 0; border-bottom: 1px solid var(--line); }
th { font-weight: 600; vertical-align: bottom; border-bottom: 2px solid var(--line); }
th.n { text-align: right; }
td.n { text-align: right; white-space: nowrap; }
td.v, th.v { white-space: nowrap; }
td.wide { min-width: 16rem; overflow-wrap: anywhere; }
td.wide:empty { min-width: 0; }
.record td { overflow-wrap: anywhere; min-width: 6rem; }
.unit { font-weight: 400; color: var(--soft); }
footer { margin-top: 3rem; border-top: 1px solid var(--line); padding-top: 0.6rem; color: var(--soft); font-size: 0.88rem; }
@media print {
  :root { --paper: #ffffff; --ink: #000000; --soft: #444444; --line: #bbbbbb; --fill: #f4f4f4; --link: #000000; --warn: #000000;
    --warnfill: #ffffff; --c0: #1f5fae; --c1: #c2410c; --c2: #15803d; --c3: #7e22ce; --c4: #b45309; --c5: #0e7490; --c6: #be185d;
    --c7: #4d5560; }
  main { max-width: none; padding: 0; }
  body { font-size: 10.5pt; }
  h2, h3, h4 { break-after: avoid; }
  figure, tr, .missing { break-inside: avoid; }
  .table { overflow: visible; }
}
)";

} // namespace lamella::reports
