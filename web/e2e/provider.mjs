/**
 * An OpenID Connect provider for the browser's tests: `node provider.mjs EMAIL`. It signs by
 * RS256 with a key of its own, takes a code once and with the verifier that its challenge was
 * made from (RFC 7636), and lets whoever comes be the person of that e-mail, or nobody known.
 * Says where it listens in a line.
 */
import { createHash, createSign, generateKeyPairSync, randomUUID } from 'node:crypto';
import { createServer } from 'node:http';

const [email] = process.argv.slice(2);
const clientId = process.env.BINNACLE_OIDC_CLIENT_ID ?? '';
const clientSecret = process.env.BINNACLE_OIDC_CLIENT_SECRET ?? '';
const { privateKey, publicKey } = generateKeyPairSync('rsa', { modulusLength: 2048 });
const kid = 'of-today';
/** By code: what it was asked for with, and who it is for. */
const codes = new Map();

const base64url = (value) => Buffer.from(value).toString('base64url');

function signed(claims) {
  const head = base64url(JSON.stringify({ alg: 'RS256', kid, typ: 'JWT' }));
  const text = `${head}.${base64url(JSON.stringify(claims))}`;
  return `${text}.${createSign('RSA-SHA256').update(text).sign(privateKey).toString('base64url')}`;
}

function page(asked) {
  const link = (who) => {
    const code = randomUUID();
    codes.set(code, { ...asked, email: who });
    const back = new URL(asked.redirect_uri);
    back.searchParams.set('code', code);
    back.searchParams.set('state', asked.state);
    return `<p><a href="${back.href.replaceAll('&', '&amp;')}">Continue as ${who}</a></p>`;
  };
  const body = `<h1>Test Lines</h1>${link(email)}${link('nobody@test.example')}`;
  return `<!doctype html><html lang="en"><title>Test Lines</title><body>${body}</body></html>`;
}

function token(sent, authorization) {
  const basic = `Basic ${Buffer.from(`${clientId}:${clientSecret}`).toString('base64')}`;
  const asked = codes.get(sent.get('code'));
  codes.delete(sent.get('code'));
  const challenge = createHash('sha256')
    .update(sent.get('code_verifier') ?? '')
    .digest('base64url');
  const holds =
    asked !== undefined &&
    authorization === basic &&
    sent.get('redirect_uri') === asked.redirect_uri &&
    challenge === asked.code_challenge;
  if (!holds) return undefined;
  const now = Math.floor(Date.now() / 1000);
  const id_token = signed({
    iss: issuer,
    aud: clientId,
    sub: `person of ${asked.email}`,
    nonce: asked.nonce,
    iat: now,
    exp: now + 300,
    email: asked.email,
    email_verified: true,
  });
  return { access_token: randomUUID(), token_type: 'Bearer', id_token };
}

async function bodyOf(request) {
  let body = '';
  for await (const part of request) body += part;
  return new URLSearchParams(body);
}

const server = createServer((request, response) => {
  void (async () => {
    const url = new URL(request.url, issuer);
    const json = (value, status = 200) => {
      response.writeHead(status, { 'Content-Type': 'application/json' });
      response.end(JSON.stringify(value));
    };
    switch (url.pathname) {
      case '/.well-known/openid-configuration':
        return json({
          issuer,
          authorization_endpoint: `${issuer}/authorize`,
          token_endpoint: `${issuer}/token`,
          jwks_uri: `${issuer}/keys`,
          response_types_supported: ['code'],
          subject_types_supported: ['public'],
          id_token_signing_alg_values_supported: ['RS256'],
        });
      case '/keys':
        return json({
          keys: [{ ...publicKey.export({ format: 'jwk' }), use: 'sig', alg: 'RS256', kid }],
        });
      case '/authorize':
        response.writeHead(200, { 'Content-Type': 'text/html; charset=utf-8' });
        return response.end(page(Object.fromEntries(url.searchParams)));
      case '/token': {
        const given = token(await bodyOf(request), request.headers.authorization);
        return given ? json(given) : json({ error: 'invalid_grant' }, 400);
      }
      default:
        response.writeHead(204);
        return response.end();
    }
  })();
});

let issuer = '';
server.listen(0, '127.0.0.1', () => {
  issuer = `http://127.0.0.1:${server.address().port}`;
  console.log(issuer);
});
