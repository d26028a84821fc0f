# Installs the command rumbo for this user.
$ErrorActionPreference = 'Stop'
$files = if ($env:RUMBO_FILES) { $env:RUMBO_FILES } else { '@FILES@' }
if (-not $files) { throw "install.ps1: set RUMBO_FILES to the address of a release's files" }
$name = 'rumbo-@VERSION@-x86_64-windows.tar.gz'
$prefix = Join-Path $env:LOCALAPPDATA 'Programs\rumbo'
$folder = New-Item -ItemType Directory (Join-Path ([IO.Path]::GetTempPath()) ([IO.Path]::GetRandomFileName()))
try {
  Invoke-WebRequest "$files/$name" -OutFile "$folder\$name"
  Invoke-WebRequest "$files/SHA256SUMS" -OutFile "$folder\SHA256SUMS"
  $line = Select-String -Path "$folder\SHA256SUMS" -Pattern ([regex]::Escape($name) + '$')
  $sum = (Get-FileHash "$folder\$name" -Algorithm SHA256).Hash
  if (-not $line -or $line.Line.Split(' ')[0] -ne $sum) {
    throw "install.ps1: $name is not the file that the release names; nothing is installed"
  }
  New-Item -ItemType Directory -Force $prefix | Out-Null
  tar -xzf "$folder\$name" --strip-components=1 -C $prefix
  Write-Output "installed $prefix\bin\rumbo.exe"
  $path = [Environment]::GetEnvironmentVariable('Path', 'User')
  if ($path -notlike "*$prefix\bin*") {
    [Environment]::SetEnvironmentVariable('Path', "$path;$prefix\bin", 'User')
    Write-Output 'it is on the PATH of new windows'
  }
} finally {
  Remove-Item -Recurse -Force $folder
}
