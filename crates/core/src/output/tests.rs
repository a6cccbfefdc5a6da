//! Unit tests of `output`.

use super::*;

fn entry_count(folder: &Path) -> usize {
    fs::read_dir(folder).unwrap().count()
}

#[test]
fn a_failed_write_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("existing");
    fs::create_dir(&path).unwrap();
    assert!(write_atomic(&path, b"x").is_err());
    assert_eq!(entry_count(folder.path()), 1);
}

#[test]
fn a_new_file_never_replaces_another() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new");
    write_new(&path, b"first").unwrap();
    assert_eq!(write_new(&path, b"second").unwrap_err().kind(), ErrorKind::AlreadyExists);
    assert_eq!((entry_count(folder.path()), fs::read(&path).unwrap()), (1, b"first".to_vec()));
    assert_eq!(write_new(folder.path(), b"x").unwrap_err().kind(), ErrorKind::AlreadyExists);
    assert!(write_new(Path::new(""), b"x").is_err());
}

#[test]
fn messages_name_no_temporary_file() {
    let error = write_atomic(Path::new("no/such/folder/out"), b"x").unwrap_err();
    assert_eq!(error.to_string(), "no such folder");
}

#[test]
fn two_paths_to_one_file_have_one_destination() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| destination(&folder.path().join(name)).unwrap();
    fs::create_dir(folder.path().join("inner")).unwrap();
    assert_eq!(at("new.csv"), at("inner/../new.csv"));
    assert_eq!(at("later/new.csv"), at("later/./sub/../new.csv"));
    assert_eq!(at("later/../new.csv"), at("new.csv"));
    assert_ne!(at("new.csv"), at("inner/new.csv"));
    assert!(write_atomic(Path::new(""), b"x").is_err());
}

#[test]
fn a_staged_file_replaces_the_existing_one_only_when_it_is_committed() {
    let folder = tempfile::tempdir().unwrap();
    let [kept, new] = ["kept", "new"].map(|name| folder.path().join(name));
    fs::write(&kept, "old").unwrap();
    drop(stage(&kept, b"dropped").unwrap());
    assert_eq!((entry_count(folder.path()), fs::read(&kept).unwrap()), (1, b"old".to_vec()));
    let both = [&kept, &new].map(|path| stage(path, b"new").unwrap());
    assert_eq!(fs::read(&kept).unwrap(), b"old");
    both.into_iter().for_each(|file| file.commit().unwrap());
    assert_eq!((fs::read(&kept).unwrap(), fs::read(&new).unwrap()), (b"new".to_vec(), b"new".to_vec()));
    assert_eq!(entry_count(folder.path()), 2);
}

#[test]
fn a_pending_file_that_is_dropped_leaves_the_old_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept");
    fs::write(&path, "old").unwrap();
    let mut file = PendingFile::create(&path).unwrap();
    file.write_all(b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    drop(file);
    assert_eq!((entry_count(folder.path()), fs::read(&path).unwrap()), (1, b"old".to_vec()));
    let mut file = PendingFile::create(&path).unwrap();
    file.write_all(b"new").unwrap();
    file.commit().unwrap();
    assert_eq!((entry_count(folder.path()), fs::read(&path).unwrap()), (1, b"new".to_vec()));
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_without_write_access_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    assert!(check_folder_writable(folder.path()).is_ok());
    assert_eq!(entry_count(folder.path()), 0);
    assert!(check_folder_writable("/proc").is_err());
    assert!(check_writable("/proc/new.csv").is_err() && check_appendable("/proc/new.csv").is_err());
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    assert!(check_writable(&file).is_ok() && check_appendable(&file).is_ok());
    assert_eq!(entry_count(folder.path()), 1);
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{PermissionsExt as _, symlink};

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn links_are_followed_and_stay() {
        let folder = tempfile::tempdir().unwrap();
        let [link, file] = ["link", "file"].map(|name| folder.path().join(name));
        symlink("file", &link).unwrap();
        for text in ["dangling", "existing"] {
            write_atomic(&link, text.as_bytes()).unwrap();
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            assert_eq!(fs::read_to_string(&file).unwrap(), text);
        }
        assert_eq!(destination(&link).unwrap(), destination(&file).unwrap());
        assert_eq!(entry_count(folder.path()), 2);
    }

    #[test]
    fn a_file_is_the_same_through_links_of_both_kinds() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let identity = |name: &str| FileIdentity::of(path(name)).unwrap();
        fs::write(path("file"), "x").unwrap();
        fs::write(path("other"), "x").unwrap();
        symlink("file", path("link")).unwrap();
        fs::hard_link(path("file"), path("name")).unwrap();
        symlink("new", path("dangling")).unwrap();
        let same = ["link", "name", "./file"].map(|name| identity(name).is_same(&identity("file")));
        assert_eq!(same, [true; 3]);
        assert!(identity("dangling").is_same(&identity("new")));
        assert!(!identity("other").is_same(&identity("file")));
    }

    #[test]
    fn cyclic_links_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        symlink("link", &link).unwrap();
        assert!(write_atomic(&link, b"x").is_err());
    }

    #[test]
    fn a_file_keeps_its_mode_and_a_new_one_gets_the_usual() {
        let folder = tempfile::tempdir().unwrap();
        let [usual, new, kept] = ["usual", "new", "kept"].map(|name| folder.path().join(name));
        fs::write(&usual, "x").unwrap();
        write_atomic(&new, b"x").unwrap();
        assert_eq!(mode(&new), mode(&usual));
        for wanted in [0o600, 0o664, 0o755] {
            fs::write(&kept, "old").unwrap();
            fs::set_permissions(&kept, fs::Permissions::from_mode(wanted)).unwrap();
            write_atomic(&kept, b"new").unwrap();
            assert_eq!((mode(&kept), fs::read(&kept).unwrap()), (wanted, b"new".to_vec()));
            PendingFile::create(&kept).unwrap().commit().unwrap();
            assert_eq!((mode(&kept), fs::read(&kept).unwrap()), (wanted, Vec::new()));
        }
    }

    #[test]
    fn a_read_only_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        assert_eq!(write_atomic(&path, b"new").unwrap_err().kind(), ErrorKind::PermissionDenied);
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn a_pipe_is_written_into() {
        use std::os::unix::fs::FileTypeExt as _;
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        write_atomic(&pipe, b"through").unwrap();
        assert_eq!(reader.join().unwrap(), b"through");
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap().len()
        });
        // More bytes than stay in memory.
        let mut file = PendingFile::create(&pipe).unwrap();
        (0..20).for_each(|_| file.write_all(&[b'x'; 100_000]).unwrap());
        file.commit().unwrap();
        assert_eq!(reader.join().unwrap(), 2_000_000);
        assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
    }
}
