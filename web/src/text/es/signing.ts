import type * as en from '../signing';
import type { Translation } from './translation';

export const signing: Translation<typeof en.signing> = {
  title: 'Claves de firma',
  lead: 'La empresa firma sus actas con una clave. A quien lee las pruebas de un acta se le dice que una clave registrada es de la empresa.',
  none: 'No hay ninguna registrada: lo que firma la empresa consta como de clave desconocida.',
  notYours: 'Las claves de firma son de las personas de una empresa que compensa agujas.',
  add: 'Registrar una clave',
  registered: 'La clave está registrada.',
  revoke: 'Revocar',
  revokeNamed: (name) => `Revocar ${name}`,
  revokeQuestion:
    'Lo que firmó sigue firmado; desde ahora no responde de nada, y no se puede recuperar.',
  revokeConfirm: 'Revocarla',
  isRevoked: 'La clave está revocada.',
  form: {
    name: 'Nombre',
    nameMissing: 'Dar un nombre a la clave, como «Oficina, 2026».',
    lead: 'Sin una clave propia, se puede crear una en este navegador. Su mitad privada es solo de la empresa: no se envía ni se guarda aquí.',
    make: 'Crear una clave',
    cannotMake:
      'Este navegador no puede crearla: debe ser reciente, y la página estar abierta con TLS.',
    made: 'Se ha creado una clave. Guardar ahora su mitad privada donde solo la empresa pueda leerla: no se vuelve a mostrar.',
    save: 'Guardar la clave privada',
    notSaved: 'Guardar primero la clave privada: sin ella nadie puede firmar.',
    own: 'Su mitad pública y la prueba',
    ownLead: (said) =>
      `La prueba es la firma de la clave sobre «${said}». OpenSSL crea una clave y después los dos campos:`,
    commands: 'Órdenes para OpenSSL',
    key: 'Clave pública, 64 cifras hexadecimales',
    keyWrong: 'La clave pública no son 64 cifras hexadecimales.',
    proof: 'Prueba, 128 cifras hexadecimales',
    proofWrong: 'La prueba no son 128 cifras hexadecimales.',
    submit: 'Registrarla',
    busy: 'Registrando…',
  },
};
