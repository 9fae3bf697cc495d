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

function player(number, data) {
  const panel = document.getElementById(`controls${number}`), curves = document.getElementById(`time${number}`);
  const view = bodyView(document.getElementById(`body${number}`), data);
  const button = panel.querySelector('button'), slider = panel.querySelector('input');
  const speed = panel.querySelector('select'), output = panel.querySelector('output');
  const line = document.createElement('div'), last = data.times[data.times.length - 1];
  line.className = 'cursor';
  let playing = false, time = data.times[0], before = 0;

  function frameAt(seconds) {
    let low = 0, high = data.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (data.times[middle] <= seconds) low = middle; else high = middle - 1;
    }
    return low;
  }

  function show() {
    const frame = frameAt(time);
    view.show(frame);
    slider.value = frame;
    output.textContent = `t = ${data.times[frame].toFixed(3)} s`;
    const layout = curves && curves._fullLayout;
    if (!layout) return;
    if (!line.parentNode) curves.appendChild(line);
    const axis = layout.xaxis, left = axis.l2p(time);
    line.style.left = `${axis._offset + left}px`;
    line.style.display = left >= 0 && left <= axis._length ? 'block' : 'none';
  }

  function step(now) {
    if (!playing) return;
    time += (now - before) * 1e-3 * Number(speed.value);
    before = now;
    if (time > last) time = data.times[0];
    show();
    requestAnimationFrame(step);
  }

  button.onclick = () => {
    playing = !playing;
    button.textContent = playing ? 'pause' : 'play';
    before = performance.now();
    if (playing) requestAnimationFrame(step);
  };
  slider.oninput = () => { time = data.times[slider.value]; show(); };
  show();
  return {
    link() {
      curves.on('plotly_hover', event => { if (!playing) { time = Math.min(event.points[0].x, last); show(); } });
      curves.on('plotly_relayout', show);
      show();
    },
  };
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
    await Plotly.newPlot(div, data, themed(layout), {displaylogo: false, responsive: true, plotlyServerURL: '',
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
