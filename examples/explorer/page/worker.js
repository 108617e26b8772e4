// Answers questions one after the other. The first message is the compiled module.
let module, wasm;
function start(compiled) {
  module = compiled;
  wasm = new WebAssembly.Instance(module).exports;
}

function answer(question) {
  const text = new TextEncoder().encode(question);
  const at = wasm.buffer(text.length);
  new Uint8Array(wasm.memory.buffer, at, text.length).set(text);
  const length = wasm.compute();
  const from = wasm.buffer(length);
  return new TextDecoder().decode(new Uint8Array(wasm.memory.buffer, from, length));
}

onmessage = ({ data }) => {
  if (data instanceof WebAssembly.Module) return start(data);
  try {
    postMessage(answer(data));
  } catch (error) {
    start(module);
    postMessage(JSON.stringify({ words: [], series: [], cells: [], error: String(error) }));
  }
};
