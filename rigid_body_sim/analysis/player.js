// SPDX-License-Identifier: Apache-2.0
// Plays the body of a page: a button, a time line, and a cursor in the curves if there are any.
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
    const next = data.times[frame + 1];
    view.show(frame, next > data.times[frame] ? Math.max(0, (time - data.times[frame]) / (next - data.times[frame])) : 0);
    slider.value = frame;
    output.textContent = `t = ${time.toFixed(3)} s`;
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
