// SPDX-License-Identifier: Apache-2.0
// Unpacks what a report carries, draws its figures when they come into sight, links body and curves.
async function unpacked(id) {
  const bytes = Uint8Array.from(atob(document.getElementById(id).textContent.trim()), c => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).text();
}

function themed(layout) {
  const color = getComputedStyle(document.body).color, grid = 'rgba(128,128,128,0.28)';
  layout.paper_bgcolor = layout.plot_bgcolor = 'rgba(0,0,0,0)';
  layout.font = {...layout.font, color};
  for (const name of Object.keys(layout).filter(key => /^[xy]axis/.test(key))) {
    Object.assign(layout[name], {gridcolor: grid, zerolinecolor: grid, linecolor: grid});
  }
  for (const axis of ['xaxis', 'yaxis', 'zaxis']) {
    if (layout.scene) layout.scene[axis] = {...layout.scene[axis], gridcolor: grid, backgroundcolor: 'rgba(0,0,0,0)'};
  }
  return layout;
}

// Thin lines in the colours of the palette are too dark for a dark page: brighter ones stand for them there.
const BRIGHTER = {'#0072B2': '#56B4E9', '#D55E00': '#FF8C42', '#009E73': '#33D6A6', '#CC79A7': '#E8A3C9'};

function brightened(data) {
  if (!matchMedia('(prefers-color-scheme: dark)').matches) return data;
  for (const {line} of data) if (line && line.color in BRIGHTER) line.color = BRIGHTER[line.color];
  return data;
}

async function openReport() {
  const packed = JSON.parse(await unpacked('data'));
  const players = Object.entries(packed.bodies).map(([number, data]) => [number, player(number, data)]);
  const script = document.createElement('script');
  script.textContent = await unpacked('plotly');
  document.head.appendChild(script);
  const linked = Object.fromEntries(players.map(([number, one]) => [`time${number}`, one]));
  const draw = async div => {
    const {data, layout} = packed.figures[div.id];
    await Plotly.newPlot(div, brightened(data), themed(layout), {displaylogo: false, responsive: true, plotlyServerURL: '',
      // nothing that uploads
      modeBarButtons: [layout.scene ? ['toImage', 'orbitRotation', 'pan3d', 'resetCameraDefault3d']
        : ['toImage', 'zoom2d', 'pan2d', 'resetScale2d']]});
    if (linked[div.id]) linked[div.id].link();
  };
  // a folded figure is drawn when it comes into sight
  const seen = new IntersectionObserver(entries => entries.filter(one => one.isIntersecting).forEach(one => {
    seen.unobserve(one.target);
    draw(one.target);
  }), {rootMargin: '400px'});
  document.querySelectorAll('.figure').forEach(div => seen.observe(div));
}
openReport();
