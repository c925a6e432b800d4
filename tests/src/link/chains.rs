//! Certificates of a server as authorities issue them, to measure what they cost on the link.

use super::satellite::Certificates;
use anyhow::{Context, Result, ensure};
use rcgen::{
    BasicConstraints, CertificateParams, CertifiedIssuer, CustomExtension, DistinguishedName,
    DnType, IsCa, KeyPair, PKCS_ECDSA_P256_SHA256,
};
use std::net::IpAddr;
use std::path::Path;
use std::process::Command;

/// Chain that the server sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chain {
    /// ECDSA P-256: a leaf of the trusted root.
    EcdsaLeaf,
    /// RSA 2048: a leaf and its intermediate authority.
    RsaTwo,
    /// RSA 2048: a leaf, its intermediate authority, and the root signed by another one.
    RsaThree,
}

/// Signed timestamps of certificate logs (RFC 6962, 3.3).
const TIMESTAMPS: &[u64] = &[1, 3, 6, 1, 4, 1, 11_129, 2, 4, 2];
/// Addresses of the authority (RFC 5280, 4.2.2.1). Those of revocation lists and policies count here
/// too.
const ADDRESSES: &[u64] = &[1, 3, 6, 1, 5, 5, 7, 1, 1];
/// Extensions, and their bytes, in a public authority's leaf beside its names and keys.
const LEAF_EXTENSIONS: &[(&[u64], usize)] = &[(TIMESTAMPS, 242), (ADDRESSES, 87)];
/// Extensions in an intermediate authority's certificate.
const AUTHORITY_EXTENSIONS: &[(&[u64], usize)] = &[(ADDRESSES, 82)];

impl Chain {
    /// Makes the chain for a server at an address, and writes it.
    ///
    /// # Errors
    /// Fails when the folder cannot be written, or `openssl`, which makes RSA keys, is missing.
    pub fn make(self, folder: &Path, server: IpAddr) -> Result<Certificates> {
        let mut issuer = CertifiedIssuer::self_signed(authority("Example Root X0")?, self.key()?)?;
        let trusted = issuer.pem();
        let mut above = String::new();
        for name in self.authorities() {
            issuer = CertifiedIssuer::signed_by(authority(name)?, self.key()?, &issuer)?;
            above.insert_str(0, &issuer.pem());
        }
        let mut leaf = CertificateParams::new([server.to_string()])?;
        leaf.distinguished_name = named("fleet.example.com");
        if self != Chain::EcdsaLeaf {
            leaf.custom_extensions = extensions(LEAF_EXTENSIONS);
        }
        let key = self.key()?;
        let leaf = leaf.signed_by(&key, &issuer)?.pem();
        Certificates::write(folder, server, &trusted, &(leaf + &above), &key)
    }

    /// Authorities between the trusted root and the leaf.
    fn authorities(self) -> &'static [&'static str] {
        match self {
            Chain::EcdsaLeaf => &[],
            Chain::RsaTwo => &["R10"],
            Chain::RsaThree => &["Example Root X1", "R10"],
        }
    }

    fn key(self) -> Result<KeyPair> {
        if self == Chain::EcdsaLeaf {
            return Ok(KeyPair::generate_for(&PKCS_ECDSA_P256_SHA256)?);
        }
        let made = Command::new("openssl")
            .args(["genpkey", "-quiet", "-algorithm", "RSA"])
            .args(["-pkeyopt", "rsa_keygen_bits:2048"])
            .output()
            .context("openssl")?;
        ensure!(made.status.success(), "{made:?}");
        Ok(KeyPair::from_pem(&String::from_utf8(made.stdout)?)?)
    }
}

fn authority(name: &str) -> Result<CertificateParams> {
    let mut authority = CertificateParams::new(Vec::<String>::new())?;
    authority.distinguished_name = named(name);
    authority.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
    authority.custom_extensions = extensions(AUTHORITY_EXTENSIONS);
    Ok(authority)
}

fn named(name: &str) -> DistinguishedName {
    let mut names = DistinguishedName::new();
    names.push(DnType::CountryName, "US");
    names.push(DnType::OrganizationName, "Example Authority");
    names.push(DnType::CommonName, name);
    names
}

fn extensions(sizes: &[(&[u64], usize)]) -> Vec<CustomExtension> {
    let extension = |(identifier, size): &(&[u64], usize)| {
        CustomExtension::from_oid_content(identifier, vec![0; *size])
    };
    sizes.iter().map(extension).collect()
}
