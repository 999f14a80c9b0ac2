// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/curve.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/text.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactus::report {
namespace {

constexpr std::string_view style = R"css(
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;background:var(--tactus-surface);color:var(--tactus-text);
font:1rem/1.55 system-ui,"Helvetica Neue",Arial,"DejaVu Sans",sans-serif}
main,footer{max-width:72rem;margin:0 auto;padding:0 1.25rem}
main{padding-top:2rem;padding-bottom:2rem}
h1,h2,h3,h4,h5,h6{line-height:1.25;margin:2em 0 .6em;text-wrap:balance}
h1{font-size:1.9rem;margin-top:0}
h2{font-size:1.35rem}
h3{font-size:1.1rem}
h4,h5,h6{font-size:1rem}
p,dl,pre{max-width:44rem}
p{overflow-wrap:break-word}
a,button{color:var(--tactus-accent)}
figure{margin:1.75rem 0}
figcaption{max-width:44rem;margin-top:.6rem;font-size:.92rem;color:var(--tactus-muted)}
figcaption strong{color:var(--tactus-text)}
.scroll{overflow-x:auto}
.scroll:not(.picture){background:linear-gradient(to right,var(--tactus-surface) 40%,transparent) 0/3rem 100% no-repeat local,
linear-gradient(to left,var(--tactus-surface) 40%,transparent) 100%/3rem 100% no-repeat local,
linear-gradient(to right,var(--tactus-frame),transparent) 0/.9rem 100% no-repeat scroll,
linear-gradient(to left,var(--tactus-frame),transparent) 100%/.9rem 100% no-repeat scroll}
.cue{margin:.2rem 0 0;font-size:.82rem;color:var(--tactus-muted)}
summary{cursor:pointer;color:var(--tactus-accent);margin:1rem 0 .5rem}
.scroll:focus-visible,button:focus-visible{outline:2px solid var(--tactus-accent);outline-offset:2px}
.picture svg{display:block;width:100%;height:auto;max-width:calc(var(--width)*1px);
min-width:calc(var(--width)*.85px)}
table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums;margin:1rem 0}
caption{text-align:left;font-weight:600;padding-bottom:.5rem}
th,td{text-align:left;padding:.32rem .9rem .32rem 0;vertical-align:baseline;white-space:nowrap}
th+th,th+td,td+td{padding-left:.9rem}
thead th{white-space:normal;min-width:4.5rem}
.text{white-space:normal;min-width:16rem}
thead th{border-top:2px solid var(--tactus-frame);border-bottom:1px solid var(--tactus-frame);vertical-align:bottom}
thead .unit{display:block;font-weight:400;color:var(--tactus-muted)}
tbody th{font-weight:400}
tbody tr+tr>*{border-top:1px solid var(--tactus-grid)}
tbody tr:last-child>*{border-bottom:2px solid var(--tactus-frame)}
.number{text-align:right}
pre{overflow-x:auto;padding:.8rem 1rem;border:1px solid var(--tactus-grid);border-radius:.4rem;font-size:.86rem;
line-height:1.45}
code,pre{font-family:ui-monospace,"DejaVu Sans Mono",Menlo,Consolas,monospace}
.label{margin:1.2rem 0 -.5rem;font-size:.88rem;color:var(--tactus-muted)}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.25rem 1.5rem}
dt{color:var(--tactus-muted)}
dd{margin:0;overflow-wrap:anywhere}
footer{padding-top:1rem;padding-bottom:2rem;border-top:1px solid var(--tactus-grid);font-size:.86rem;
color:var(--tactus-muted);overflow-wrap:anywhere}
.enlarge{display:block;margin:.4rem 0 0;padding:.15rem .6rem;font:inherit;font-size:.82rem;cursor:pointer;
background:none;border:1px solid var(--tactus-frame);border-radius:.3rem}
.zooms svg{cursor:zoom-in}
dialog{width:100vw;height:100vh;max-width:none;max-height:none;padding:2.8rem 1rem 1rem;border:0;overflow:auto;
background:var(--tactus-surface);color:var(--tactus-text)}
dialog::backdrop{background:var(--tactus-surface)}
dialog svg{display:block;height:auto;margin:0 auto;cursor:zoom-out;
width:max(calc(var(--width)*1.25px),min(100%,calc(86vh*var(--width)/var(--height))))}
dialog .enlarge{position:fixed;top:.6rem;right:1rem;margin:0;background:var(--tactus-surface)}
@media(max-width:40rem){main,footer{padding-left:1rem;padding-right:1rem}h1{font-size:1.5rem}
dl{grid-template-columns:1fr;gap:0}dd{margin-bottom:.6rem}}
@media print{body{font-size:10pt}main,footer{max-width:none;padding-left:0;padding-right:0}
.enlarge,.cue,dialog{display:none}.scroll{overflow:visible}.picture svg{min-width:0;max-width:100%}
figure,table,pre,tr{break-inside:avoid}h1,h2,h3,h4,h5,h6{break-after:avoid}pre{white-space:pre-wrap}}
)css";

// Written without the characters that XML reserves, so that the document is well-formed as XML too.
constexpr std::string_view script = R"js(
(function () {
  var dialog = document.createElement("dialog");
  if (!dialog.showModal) return;
  var close = document.createElement("button");
  close.className = "enlarge";
  close.textContent = "Close";
  close.onclick = function () { dialog.close(); };
  document.body.appendChild(dialog);
  document.querySelectorAll(".picture").forEach(function (picture) {
    var svg = picture.querySelector("svg");
    function open() {
      dialog.replaceChildren(close, svg.cloneNode(true));
      dialog.setAttribute("style", picture.getAttribute("style"));
      dialog.setAttribute("aria-label", picture.getAttribute("aria-label"));
      dialog.lastChild.onclick = function () { dialog.close(); };
      dialog.showModal();
    }
    var button = document.createElement("button");
    button.className = "enlarge";
    button.textContent = "Enlarge";
    button.setAttribute("aria-label", "Enlarge " + picture.getAttribute("aria-label"));
    button.onclick = open;
    svg.onclick = open;
    picture.classList.add("zooms");
    picture.onkeydown = function (event) {
      if (event.key === "Enter") { event.preventDefault(); open(); }
    };
    picture.after(button);
  });
  document.querySelectorAll(".scroll").forEach(function (part) {
    var cue = document.createElement("p");
    cue.className = "cue";
    cue.textContent = "There is more on the right: scroll sideways \u2192";
    part.after(cue);
    function look() { cue.hidden = Math.max(0, part.scrollWidth - part.clientWidth - part.scrollLeft - 4) === 0; }
    part.onscroll = look;
    window.addEventListener("resize", look);
    look();
  });
})();
)js";

std::string element(const std::string& tag, std::string_view text) {
  return "<" + tag + ">" + escape(text) + "</" + tag + ">\n";
}

/// A part that scrolls sideways by itself; focusable, so that it scrolls from the keyboard too.
std::string scrolling(const std::string& style_class, const std::string& name, const std::string& attributes,
                      const std::string& content) {
  return "<div class=\"" + style_class + "\" role=\"group\" tabindex=\"0\" aria-label=\"" + escape(name) + "\"" +
         attributes + ">\n" + content + "</div>\n";
}

}  // namespace

void Page::heading(std::string_view text, int level) {
  constexpr std::array<const char*, 5> tags{"h2", "h3", "h4", "h5", "h6"};
  body_ += element(tags[static_cast<std::size_t>(std::clamp(level, 2, 6) - 2)], text);
}

void Page::paragraph(std::string_view text) { body_ += element("p", text); }

void Page::table(const Table& table) {
  body_ += scrolling("scroll", table.caption().empty() ? "Table" : table.caption(), "", table.to_html());
}

void Page::add_picture(const Drawing& drawing, std::string_view title, std::string_view caption) {
  const std::string label = "Figure " + std::to_string(++figures_);
  std::string name = label, ahead = label + ".";
  if (!title.empty()) {
    name.append(": ").append(title);
    ahead.append(" ").append(title).append(".");
  }
  const std::string size =
      " style=\"--width:" + pixels(drawing.width_px) + ";--height:" + pixels(drawing.height_px) + "\"";
  body_ += "<figure>\n" + scrolling("scroll picture", name, size, drawing.svg) + "<figcaption><strong>" +
           escape(ahead) + "</strong> " + escape(caption) + "</figcaption>\n</figure>\n";
}

void Page::figure(const Figure& figure) { add_picture(draw(figure), figure.title, figure.caption); }

void Page::figure(const HeatMap& map, std::string_view caption) { add_picture(draw(map), map.title, caption); }

void Page::code(std::string_view text, std::string_view label) {
  if (!label.empty()) body_ += "<p class=\"label\">" + escape(label) + "</p>\n";
  const std::string name = label.empty() ? "Code" : std::string(label);
  body_ += "<pre tabindex=\"0\" role=\"group\" aria-label=\"" + escape(name) + "\"><code>" + escape(text) +
           "</code></pre>\n";
}

void Page::folded(std::string_view text, std::string_view label) {
  body_ += "<details>\n<summary>" + escape(label) + "</summary>\n<pre tabindex=\"0\" role=\"group\" aria-label=\"" +
           escape(label) + "\"><code>" + escape(text) + "</code></pre>\n</details>\n";
}

void Page::definitions(const std::vector<std::pair<std::string, std::string>>& entries) {
  body_ += "<dl>\n";
  for (const auto& [term, meaning] : entries)
    body_ += "<dt>" + escape(term) + "</dt><dd>" + escape(meaning) + "</dd>\n";
  body_ += "</dl>\n";
}

void Page::footer(std::string_view text, std::string_view command) {
  footer_ = "<footer>" + escape(text);
  if (!command.empty()) footer_ += " <code>" + escape(command) + "</code>";
  footer_ += "</footer>\n";
}

std::string Page::to_html() const {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
  html +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "script-src 'unsafe-inline'\"/>\n";
  html += element("title", title_) + "<style>\n" + figure_style();
  html += style;
  html += "</style>\n</head>\n<body>\n<main>\n" + element("h1", title_) + body_ + "</main>\n" + footer_;
  html += "<script>";
  html += script;
  html += "</script>\n</body>\n</html>\n";
  return html;
}

}  // namespace tactus::report
