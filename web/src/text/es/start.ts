import type * as en from '../start';
import type { Translation } from './translation';

export const firstRun: Translation<typeof en.firstRun> = {
  title: 'Poner en marcha este servidor',
  tagline: 'Todavía no tiene usuarios. Crear la compañía y la cuenta.',
  code: 'Código de puesta en marcha',
  codeHelp: 'En el servidor lo imprime binnacle-server admin first-run. Vale un día.',
  company: 'Compañía',
  name: 'Nombre',
  email: 'Correo electrónico',
  password: 'Contraseña',
  submit: 'Crear compañía y cuenta',
  busy: 'Creando…',
  missing: 'Rellenar todos los campos.',
  unknown: 'Este código no existe. Imprimir otro en el servidor.',
  made: (email) => `La compañía está creada, con la cuenta ${email}.`,
  notSignedIn: (why) => `No se ha podido iniciar sesión: ${why}`,
  demo: 'Para echar antes un vistazo, make demo pone en marcha una flota de buques simulados junto a este servidor.',
};

export const forgotten: Translation<typeof en.forgotten> = {
  open: '¿Contraseña olvidada?',
  lead: 'Se envía un enlace para fijar una contraseña nueva. Vale una hora.',
  submit: 'Enviar el enlace',
  busy: 'Enviando…',
  sent: (email) =>
    `Si ${email} tiene cuenta aquí, hay un correo en camino. Revisar el buzón de entrada.`,
  missing: 'Introducir la dirección de correo.',
  back: 'Volver al inicio de sesión',
};

export const start: Translation<typeof en.start> = {
  title: 'Primeros pasos',
  link: (n) =>
    n === 1
      ? 'Primeros pasos: 1 buque no está en directo'
      : `Primeros pasos: ${n} buques no están en directo`,
  lead: 'Lo que un buque necesita hasta que se mide su desvío y se planifican sus compensaciones.',
  vessels: 'Buques',
  add: 'Añadir un buque',
  file: 'Añadir buques desde un archivo',
  fileLead:
    'Un archivo CSV cuya primera línea nombra las columnas: name, imo_number, call_sign, flag. Solo hace falta el nombre.',
  which: 'Archivo, .csv',
  sample: 'Descargar un archivo de ejemplo',
  send: 'Añadir los buques',
  sending: 'Añadiendo…',
  fileMissing: 'Elegir un archivo.',
  added: (n) => (n === 1 ? '1 buque está añadido.' : `${n} buques están añadidos.`),
  duplicates: (number, names) =>
    `El número IMO ${number} figura en varios buques: ${names}. Corregir todos menos uno, o darlos de baja.`,
  none: 'Añadir arriba el primer buque.',
  next: 'Después',
  firms: 'Añadir las empresas que compensan las agujas',
  calls: 'Registrar escalas, o enviar un archivo con ellas',
  people: 'Invitar a los compañeros',
  checklist: 'Lista de comprobación',
  vessel: 'Buque',
  step: {
    agent: 'Agente',
    model: 'Modelo',
    adjusted: 'Última compensación',
    call: 'Escalas',
    particulars: 'Características',
  },
  todo: {
    agent: 'Todavía sin datos: ver el agente',
    model: 'Esperando muestras',
    adjusted: 'No se conoce',
    compass: 'Sin aguja',
    notAsked: 'Todavía no se sabe',
    call: 'Registrar escalas',
    particulars: (missing) => (missing === 1 ? 'Completar 1 dato' : `Completar ${missing} datos`),
  },
  done: { agent: 'envía', model: 'medido', call: 'registradas', particulars: 'completas' },
  live: 'en directo',
  record: 'Anotar la fecha',
  recording: 'Anotando…',
  day: (vessel) => `Día de la última compensación de ${vessel}`,
  dayMissing: 'Elegir un día.',
};
