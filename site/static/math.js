// Sets the mathematics of a page with KaTeX, from the folder of this script. Without it the TeX remains readable.
const folder = new URL('.', document.currentScript.src);

function load(tag, attributes) {
  const element = Object.assign(document.createElement(tag), attributes);
  return new Promise((loaded, failed) => {
    element.onload = loaded;
    element.onerror = failed;
    document.head.append(element);
  });
}

async function setMathematics() {
  await Promise.all([
    load('link', { rel: 'stylesheet', href: new URL('katex/katex.min.css', folder) }),
    load('script', { src: new URL('katex/katex.min.js', folder) }),
  ]);
  for (const element of document.querySelectorAll('.math')) {
    // Sphinx puts the TeX between \( and \), or \[ and \].
    const tex = element.textContent.trim().replace(/^\\[([]|\\[)\]]$/g, '');
    katex.render(tex, element, { displayMode: element.tagName === 'DIV', throwOnError: false });
  }
}

setMathematics();
