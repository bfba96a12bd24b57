/** A TCP relay in front of the service that can be cut and mended: what the page sees when the service restarts. */
import { createServer, connect } from "node:net";
import { once } from "node:events";

export async function breakableProxy(target) {
  const { hostname, port } = new URL(target);
  const sockets = new Set();
  const server = createServer((client) => {
    const upstream = connect({ host: hostname, port: Number(port) });
    for (const [one, other] of [[client, upstream], [upstream, client]]) {
      sockets.add(one);
      one.on("error", () => other.destroy());
      one.on("close", () => {
        sockets.delete(one);
        other.destroy();
      });
      one.pipe(other);
    }
  });
  const listen = async (at) => {
    server.listen(at, "127.0.0.1");
    await once(server, "listening");
    return server.address().port;
  };
  const cut = async () => {
    const closed = once(server, "close");
    server.close();
    for (const socket of sockets) socket.destroy();
    await closed;
  };
  const listeningPort = await listen(0);
  return { url: `http://127.0.0.1:${listeningPort}`, cut, mend: () => listen(listeningPort), close: cut };
}
