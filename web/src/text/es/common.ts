import type * as en from '../common';
import type { Translation } from './translation';

export const product = 'Binnacle';
export const tagline = 'La aguja magnética, corregida en la mar';
export const noMountPoint = 'index.html no tiene ningún elemento con el id "app"';

export const skip = 'Saltar al contenido';
export const loading = 'Cargando…';
export const retry = 'Reintentar';
export const chartNotLoaded = 'No se pudo cargar el gráfico. Sus cifras están en la tabla.';
export const cancel = 'Cancelar';
export const copy = 'Copiar';
export const copied = 'Copiado';
export const showMore: Translation<typeof en.showMore> = (n) => `Mostrar ${n} más`;
export const optional = 'opcional';
export const unfinished = 'Completar o vaciar este campo.';
export const utc = 'UTC';
export const asOf: Translation<typeof en.asOf> = (when) => `A fecha de ${when}`;

export const signOut = 'Cerrar sesión';

export const signIn: Translation<typeof en.signIn> = {
  title: 'Iniciar sesión',
  email: 'Correo electrónico',
  password: 'Contraseña',
  submit: 'Iniciar sesión',
  busy: 'Iniciando sesión…',
  wrong: 'El correo o la contraseña no son correctos.',
  missing: 'Introducir el correo y la contraseña.',
  code: 'Código',
  codeHelp: 'De la aplicación de autenticación, o uno de los códigos de recuperación.',
  codeWrong: 'El código no es correcto o ya se ha usado.',
  codeMissing: 'Introducir el código.',
  otherUser: 'Iniciar sesión con otra cuenta',
  or: 'o',
  by: (provider) => `Iniciar sesión con ${provider}`,
  why: {
    cancelled: 'El acceso se abandonó, o el servicio no lo permitió.',
    over: 'Ese acceso tardó demasiado, se empezó en otro navegador o ya se había terminado. Hay que intentarlo de nuevo.',
    unreachable:
      'Ahora mismo no hay conexión con el servicio de acceso. Intentarlo de nuevo o usar la contraseña.',
    untrusted:
      'La respuesta del servicio de acceso no es válida. Intentarlo de nuevo; si se repite, avisar al administrador.',
    unverified: 'El servicio de acceso no responde de ninguna dirección de correo de esta cuenta.',
    unknown:
      'Nadie con esta dirección de correo tiene acceso aquí. El administrador puede enviar una invitación a esa dirección.',
    taken:
      'Esta dirección de correo corresponde aquí a otra persona del servicio de acceso. Consultar a quien administra este servidor.',
    throttled: 'Demasiados intentos fallidos. Esperar un poco y probar de nuevo.',
    failed: 'Algo ha fallado aquí. Intentarlo de nuevo.',
  },
};

export const invitation: Translation<typeof en.invitation> = {
  title: 'Fijar la contraseña',
  help: 'Al menos 12 caracteres: unas pocas palabras que solo tengan relación para quien las elige son fáciles de recordar.',
  code: 'Código de un solo uso',
  password: 'Contraseña nueva',
  submit: 'Fijar la contraseña',
  busy: 'Guardando…',
  missing: 'Introducir el código y una contraseña.',
  unknown: 'Este código no existe o ya se ha usado. El administrador puede dar otro.',
  done: (email) => `La contraseña está fijada. Iniciar sesión como ${email}.`,
};

export const theme: Translation<typeof en.theme> = {
  label: 'Colores',
  auto: 'Automático',
  light: 'Día',
  dark: 'Noche',
};

export const live: Translation<typeof en.live> = {
  connecting: 'Conectando',
  live: 'En directo',
  lost: 'Sin directo',
  liveLong: 'Muestra los datos nuevos según llegan',
  lostLong: 'Se ha perdido la conexión en directo; reintentando',
  without: (since) =>
    `Sin conexión desde ${since}. Lo que se ve es de entonces o anterior, y los cambios pueden no llegar. Se actualiza en cuanto vuelve la conexión.`,
};

export const problem: Translation<typeof en.problem> = {
  offline: 'No hay conexión con el servidor. Comprobar la conexión.',
  offlineNothing:
    'No hay conexión con el servidor y aquí no se guarda nada de esto. Aparece en cuanto vuelve la conexión.',
  offlineStale: (since) =>
    `No hay conexión con el servidor. Lo que se ve es de ${since}; se actualiza en cuanto vuelve la conexión.`,
  stale: (since, detail) => `No se ha podido actualizar (${detail}). Lo que se ve es de ${since}.`,
  unexpected: (status) => `El servidor respondió con un error (${status}).`,
  unreadable: 'El servidor respondió en una forma que esta página no entiende.',
  superseded:
    'Se apoyaba en algo que ya no es válido. Mirar qué hay que hacer ahora y hacerlo de nuevo.',
  signedOut: 'La sesión ha terminado. Iniciar sesión de nuevo.',
  notFoundTitle: 'Aquí no hay nada',
  notFound: 'No existe esta página, o es de otra flota.',
  toVessels: 'A la flota',
  ofOperatorTitle: 'Esta página es del operador',
  ofOperator:
    'Los buques, las alertas y la planificación son para el personal de la flota. Lo que se pide a la empresa y lo que ha acordado está en sus órdenes.',
  toOrders: 'A mis órdenes',
  title: 'No se ha podido mostrar',
};

export const document: Translation<typeof en.document> = {
  fleet: 'Flota · Binnacle',
  vessel: (name) => `${name} · Binnacle`,
  signIn: 'Iniciar sesión · Binnacle',
  firstRun: 'Puesta en marcha · Binnacle',
  start: 'Primeros pasos · Binnacle',
  invitation: 'Fijar la contraseña · Binnacle',
  notFound: 'Aquí no hay nada · Binnacle',
  alerts: 'Alertas · Binnacle',
  mail: 'Correo · Binnacle',
  webhooks: 'Webhooks · Binnacle',
  orders: 'Órdenes de trabajo · Binnacle',
  schedule: 'Planificación · Binnacle',
  binnacles: 'Bitácoras · Binnacle',
  firms: 'Empresas · Binnacle',
  home: 'Mis órdenes · Binnacle',
  platform: 'Plataforma · Binnacle',
  reports: 'Informes · Binnacle',
  notifications: 'Notificaciones · Binnacle',
  settings: 'Ajustes · Binnacle',
  help: 'Ayuda · Binnacle',
  people: 'Personas · Binnacle',
  aboard: 'Agentes · Binnacle',
  audit: 'Registro de auditoría · Binnacle',
  scheduleRules: 'Reglas de planificación · Binnacle',
  newOrder: 'Encargar una compensación · Binnacle',
  order: (vessel) => `Compensación de ${vessel} · Binnacle`,
};

export const pages: Translation<typeof en.pages> = {
  label: 'Páginas',
  fleet: 'Flota',
  alerts: 'Alertas',
  unacknowledged: ' alertas que nadie ha reconocido',
  schedule: 'Planificación',
  reports: 'Informes',
  notifications: 'Notificaciones',
  unread: ' sin leer',
  orders: 'Órdenes',
  binnacles: 'Bitácoras',
  firms: 'Empresas',
  home: 'Mis órdenes',
  platform: 'Plataforma',
  settings: 'Ajustes',
  help: 'Ayuda',
  menu: 'Menú',
  yourAccount: 'Ajustes personales',
};
