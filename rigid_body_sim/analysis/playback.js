// Moves the box and the axes of a Plotly figure by recorded quaternions (x, y, z, w).
function playback(figure, controls, data) {
  const div = document.getElementById(figure), panel = document.getElementById(controls);
  const button = panel.querySelector('button'), slider = panel.querySelector('input');
  const speed = panel.querySelector('select'), output = panel.querySelector('output');
  const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(e => e.map(c => 0.95 * data.reach * c));
  let playing = false, busy = false, time = data.times[0], before = 0;

  function rotate([x, y, z, w], v) {
    const t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]];
  }

  function show(frame) {
    const q = data.orientation[frame];
    const traces = [data.corners.map(corner => rotate(q, corner)), ...axes.map(axis => [[0, 0, 0], rotate(q, axis)])];
    const part = k => traces.map(points => points.map(point => point[k]));
    output.textContent = 't = ' + data.times[frame].toFixed(3) + ' s';
    slider.value = frame;
    busy = true;
    return Plotly.restyle(div, {x: part(0), y: part(1), z: part(2)}, [0, 1, 2, 3]).then(() => { busy = false; });
  }

  function frameAt(seconds) {
    let low = 0, high = data.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (data.times[middle] <= seconds) low = middle; else high = middle - 1;
    }
    return low;
  }

  function step(now) {
    if (!playing) return;
    time += (now - before) * 1e-3 * Number(speed.value);
    before = now;
    if (time > data.times[data.times.length - 1]) time = data.times[0];
    if (!busy) show(frameAt(time));
    requestAnimationFrame(step);
  }

  button.onclick = () => {
    playing = !playing;
    button.textContent = playing ? 'pause' : 'play';
    before = performance.now();
    if (playing) requestAnimationFrame(step);
  };
  slider.oninput = () => { time = data.times[slider.value]; show(Number(slider.value)); };
  show(0);
}
